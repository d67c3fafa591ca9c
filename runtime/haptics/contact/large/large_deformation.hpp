// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <memory>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"
#include "runtime/haptics/contact/large/large_tissue.hpp"
#include "runtime/haptics/contact/large_shape.hpp"
#include "runtime/realtime/triple_buffer.hpp"

namespace palpate::haptics {

/// Large deformation beside the tick: a loop finds where neo-Hookean tissue rests under the
/// forces of the newest tick; ticks take that in as a displacement beyond their compliance, and so answer
/// changes of force by the compliance and what they change the displacement beyond by. Where the hand rests,
/// the force is that of the hyperelastic tissue. Three sides, each for one thread: the tick's, the loop's and
/// the picture's.
class LargeDeformation {
  public:
    /// Of the case's hyperelastic bodies. `bodies` must outlive this. Throws InvalidInput if one of them is
    /// no deformable body of the case; as LargeTissue. Some seconds for a large body.
    LargeDeformation(const Case& patient_case, const ContactBodies& bodies);
    ~LargeDeformation();

    bool any() const noexcept { return !tissues_.empty(); }

    /// Back to rest. Not beside any other side.
    void reset(ContactEquilibrium& equilibrium) noexcept;

    /// Tick's side, before it begins: hands newly found shapes to the equilibrium and says in the results of
    /// which tick's forces they are. Realtime-safe.
    void take(ContactEquilibrium& equilibrium, std::span<TickResult> results) noexcept;
    /// Tick's side, at its end: tells the loop which forces are there now, and in the results of tools that
    /// press hyperelastic bodies whether an answer is late or has not settled. Realtime-safe.
    void tell(const ContactEquilibrium& equilibrium, std::span<TickResult> results) noexcept;

    /// Loop's side: goes on towards the answer to the forces of the newest tick, once the tick has taken the
    /// last one: a replay knows of no other. Bodies one after the other. No allocation.
    void answer() noexcept;
    /// From now on the forces of the last remembered_ticks are kept, for answer_tick(). Not beside any side.
    void keep_forces();
    /// The same for the forces of one of them, for replays, in the tick's thread; of one that was not ticked
    /// there were none.
    void answer_tick(std::int64_t tick) noexcept;

    /// Picture's side: adds to the displacements of deformable body `soft` (mm, by surface vertex) what it is
    /// displaced beyond its compliance under the contacts of the tools' results.
    void add_beyond(std::size_t soft, std::span<const TickResult* const> results,
                    std::span<Eigen::Vector3f> displacements);

  private:
    static constexpr std::size_t remembered = remembered_ticks;
    using Forces = FixedList<SurfaceForce, 2 * static_cast<std::size_t>(DeformedPatch::most_vertices)>;
    // Of one tick, by body of `softs_`.
    struct Loads {
        std::int64_t tick = -1;
        std::int64_t taken = -1;  // whose answer the tick has taken last
        std::vector<Forces> of_body;
    };
    struct Shapes {
        std::int64_t tick = -1;  // whose forces they answer
        std::vector<LargeShape> of_body;
    };
    static constexpr std::int64_t late = 100;  // ticks: three of a loop's answers at 30 Hz
    static Loads none(std::size_t bodies);
    Shapes rest() const;
    void answer(const Loads& loads) noexcept;
    bool presses_unsettled(const TickResult& result) const noexcept;
    static void copy(const Loads& from, Loads& to) noexcept;

    const ContactBodies& bodies_;
    std::vector<std::size_t> softs_;  // which deformable bodies; what follows by body is in their order
    std::vector<std::unique_ptr<LargeTissue>> tissues_;
    std::vector<Loads> past_;  // by tick modulo `remembered`; empty: not kept
    Loads free_;               // of a tick without forces
    realtime::TripleBuffer<Loads> loads_;
    realtime::TripleBuffer<Shapes> shapes_, drawn_;
    std::vector<SurfaceForce> drawn_forces_;
    std::int64_t taken_ = -1;       // the tick's: whose answer it took last
    std::int64_t free_until_ = -1;  // the tick's: the last in which none of the bodies was pressed
    std::int64_t answered_ = -1;    // the loop's: the tick that it answered last
};

}  // namespace palpate::haptics
