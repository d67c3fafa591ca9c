// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/haptics/methods/contact_method.hpp"
#include "runtime/realtime/triple_buffer.hpp"

namespace palpate::haptics {

/// Computes the nodal forces f_c (N) that displace the vertices of one polygon by `displacement` (mm) each:
/// C_cc f_c = u_c (Hirota, Kaneko 2001). `blocks`: the compliance block of each vertex, -1 for a fixed one,
/// which gives no freedom and gets no force. Realtime-safe, thread-safe.
std::array<Eigen::Vector3d, 3> impose_displacement(const SurfaceCompliance& compliance,
                                                   const std::array<std::int32_t, 3>& blocks,
                                                   const Eigen::Vector3d& displacement) noexcept;

/// Contact as published (Zu, Xie, Wang, Min, "Research on Force Feedback Technology in Virtual Surgery
/// Simulation"; numbers of sections and equations are that paper's), for `single` and `twice`. A collision
/// loop at 30 Hz tests whether the end-effector is inside; the servo loop turns the latest answer into force
/// (§4.2, the two loops below figure 4). The end-effector is a point: the tool's radius plays no part.
///
/// `single`, before the improvement: force while the latest detection says inside, whatever came since; so it
/// pulls when the tip leaves between two detections (figure 3, "Force2").
///
/// `twice`, after it. With the detection's result ioo and surface normal n:
///   - ioo = -1: force;
///   - else, speed . n < 0: force if the last position, 1 ms ago, is inside by a second test; if not, it
///     stays on or off as it was, for the published code leaves its flag alone there;
///   - else: no force;
///   - and none where X . n < 0, X from the position to the anchor: it would pull.
///
/// Where the paper is silent, the plain reading. The anchor is the surface point nearest to the tested
/// position, and n the normal of its triangle. A detection renews both, but not by a face that looks the
/// other way than the one in contact: §4.1 goes by "the normal of the contacted face", and a tip pressed
/// beyond the middle of a wall is still in contact with the face that it came through. So while there is
/// force, a detection whose n is against that of the contacted face leaves anchor and n as they are.
/// `single-renewed` and `twice-renewed` are the other reading: every detection renews both, so that a tip
/// past the middle of a wall is led out on the far side. `single` keeps the face as `twice` does, since what
/// improves in tables 1 and 2 is the second test; of 100 approaches as theirs it punctures about a quarter,
/// renewed about a third, published are 14, so their counts do not speak against it. A contact that the
/// second test finds has the anchor of the last position. What is first found in the far half of a wall has
/// its anchor on the far side, by either reading, and the force leads through. Detections cross to the servo
/// by a triple buffer, where the paper stops the servo for a synchronous call.
///
/// A rigid body answers with coupling_stiffness * (anchor - device). A deformable one in five steps (§3): the
/// tip is node X of the tool, S = PQR the detected triangle, F the foot of the perpendicular from X to S's
/// plane. FX (eq. 1) is imposed on P, Q, R; the surface force is f = (f_P + f_Q + f_R) / 3 (eq. 3). The
/// tool's own |f_A| is beyond any |f_B|, since it is rigid, so U_B = FX (eq. 5) and U_A = 0 (eq. 4). f_P,
/// f_Q, f_R act on the tissue, so the device feels -(f_P + f_Q + f_R), outwards when X is inside. "Inside" is
/// tested against the surface at rest. A triangle without a free vertex answers as a rigid body, along n.
class PublishedContact final : public ContactMethod {
  public:
    /// How often a position is tested between two detections.
    enum class Tested { single, twice };
    /// Whether a face in contact is kept against one that looks the other way.
    enum class Face { kept, renewed };

    /// A position that the servo asks the collision loop to test.
    struct Asked {
        std::array<double, 3> device{};  ///< p_P, mm
        std::int64_t tick = 0;           ///< of the position
        std::int64_t losses = 0;         ///< calls of lose() before it
        bool trusted = false;            ///< false: there is no position to test
    };

    /// `bodies`: of the case; must outlive this. Compliances are shared.
    PublishedContact(const Case& patient_case, const ContactBodies& bodies, Tested tested, Face face);
    ~PublishedContact() override;

    void reset() noexcept override;

    /// Servo's side, for a tick without a trusted position: drops contact, and every detection of a position
    /// from before it, whenever it comes.
    void lose() noexcept;

    Detects detects() const noexcept override { return Detects::positions; }
    /// Tests the device position of the latest tick on every body: one query of each surface. The same as
    /// answer(asked()).
    void detect() noexcept override;
    void detect_at(const std::array<double, 3>& device, std::int64_t tick) noexcept override;

    /// Collision loop's side: the position of the latest tick.
    Asked asked() noexcept { return device_.read(); }
    /// Collision loop's side: tests a position that was asked for, nothing if it is not trusted, and hands
    /// the answer to the servo.
    void answer(const Asked& asked) noexcept;

    void tick(std::span<const ContactPose> poses, const VirtualCoupling& coupling,
              std::span<TickResult> results, std::span<Eigen::Vector3d> forces) noexcept override;

    /// Servo's side, 1 kHz: takes the latest detection, decides, and returns the force on the device before
    /// any limit (N) for the end-effector at `device` (p_P, mm, finite) behind a virtual coupling (N/mm).
    /// Appends one contact per body felt to `result`, with the force's direction as its normal, and a
    /// polygon's free vertices weighted alike; raises its depth and body; says which tick's position a new
    /// detection is of, and adds collision_stale to its faults where none has come for a tenth of a second.
    /// One thread; wait-free and realtime-safe.
    Eigen::Vector3d tick(const Eigen::Vector3d& device, double coupling_stiffness,
                         TickResult& result) noexcept;

  private:
    // Where a body's surface was, or would be, touched.
    struct Foot {
        Eigen::Vector3d anchor = Eigen::Vector3d::Zero();  // mm
        Eigen::Vector3d normal = Eigen::Vector3d::Zero();  // unit, outwards
        Eigen::Vector3d barycentric = Eigen::Vector3d::Zero();
        std::int32_t triangle = -1;
    };
    struct Detection {
        int inside_or_outside = 1;  // -1 inside, 1 outside
        Foot foot;
    };
    struct Contacted {
        bool render_force = false;
        Foot foot;
    };
    // What contact with a deformable body needs of it.
    struct Elastic {
        SurfaceCompliance compliance;
        std::vector<std::int32_t> blocks;  // compliance block of each surface vertex, -1 for a fixed one
    };
    struct Answered {
        std::vector<Detection> bodies;
        std::int64_t tick = 0, losses = 0;  // of what was asked
    };

    Detection inside_or_outside(std::size_t body, const Eigen::Vector3d& p) const noexcept;
    void decide(std::size_t body, const Detection& detection, bool fresh,
                const Eigen::Vector3d& device) noexcept;
    Eigen::Vector3d force_of(std::size_t body, const Eigen::Vector3d& offset, double coupling_stiffness,
                             Contact& contact) const noexcept;

    const ContactBodies& bodies_;
    bool twice_, renewed_;
    std::vector<Elastic> elastic_;            // of the deformable bodies, the last ones
    realtime::TripleBuffer<Asked> device_{};  // servo to collision loop
    realtime::TripleBuffer<Answered> detections_;
    std::vector<Contacted> contacted_;            // the servo's
    std::optional<Eigen::Vector3d> last_device_;  // the servo's
    std::int64_t losses_ = 0;                     // calls of lose()
    bool detected_ = false;                       // since the device was last lost
    int ticks_undetected_ = 0;                    // since the last detection came
};

/// A PublishedContact, as the table of contact methods makes it.
template <PublishedContact::Tested tested, PublishedContact::Face face>
std::unique_ptr<ContactMethod> make_published(const Case& patient_case, const ContactBodies& bodies,
                                              std::size_t /*tool_count*/) {
    return std::make_unique<PublishedContact>(patient_case, bodies, tested, face);
}

}  // namespace palpate::haptics
