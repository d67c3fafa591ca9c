// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/haptics/haptic_model.hpp"

namespace palpate::experiments {

/// The surfaces at rest, asked which way is out of the tissue.
class RestNormals {
  public:
    /// Rigid bodies first, as in HapticModel.
    explicit RestNormals(const Case& patient_case);

    /// How far (N) a contact draws its tool into the body: the part of n f against the outward normals of the
    /// triangles that hold the contact's point, of the least against; 0 if it is against not all of them.
    double pull(const Contact& contact) const;
    /// Of a triangle of a body at rest: unit, outwards.
    const Eigen::Vector3d& normal(std::size_t body, std::int32_t triangle) const;

  private:
    struct Surface {
        std::vector<Triangle> triangles;
        std::vector<Eigen::Vector3d> normals;                 // of triangles, unit, outwards
        std::vector<std::vector<std::int32_t>> triangles_at;  // of each vertex
    };
    std::vector<Surface> surfaces_;
};

/// What forces were like, tick by tick.
struct ForceFigures {
    static constexpr double jump_limit = 0.5;   ///< N between successive ticks
    static constexpr double pull_limit = 1e-6;  ///< N

    /// How force changed from tick to tick.
    struct Steps {
        std::int64_t count = 0;
        std::int64_t jumps = 0;  ///< steps above jump_limit
        double largest = 0;      ///< N
        double squared_sum = 0;  ///< N²
        void add(double step);
        double roughness() const;  ///< RMS of dF/dt, N/s
    };

    std::int64_t ticks = 0, touching_ticks = 0;
    Steps wanted;    ///< of the contacts' forces, before any limit
    Steps rendered;  ///< of the force on the device, behind the limiter
    std::int64_t pulling_ticks = 0;
    double strongest_pull = 0;  ///< N, of one contact

    // Work of the device on the tip, N mm. An episode lasts while force lasts; elastic tissue stores nothing
    // at either end.
    std::int64_t episodes = 0;
    double given = 0;             ///< over all runs
    double bound = 0;             ///< what sampling allows over all runs
    double most_given = 0;        ///< the most that the device was ahead within any episode
    std::int64_t over_bound = 0;  ///< episodes that were ahead by more than their bound at any tick
    double worst_over_bound = 0;  ///< by how much
};

/// Gathers the figures of runs, tick by tick.
class ForceQuality {
  public:
    /// What a body may give to the hand, by sampling alone: a spring of stiffness K, read every tick to a
    /// grain of q per axis and held until the next, gives at most K |dx| (|dx|/2 + sqrt(3) q) a tick more
    /// than it took.
    struct Passivity {
        double stiffness = 0;  ///< K, N/mm
        double grain = 0;      ///< q, mm
    };

    /// `normals` and `model`, whose ticks these are, must outlive this.
    ForceQuality(const RestNormals& normals, const haptics::HapticModel& model, const Passivity& passivity)
        : normals_(normals), model_(model), passivity_(passivity) {}

    /// Starts another run, whose first tick follows nothing.
    void begin_run();
    /// Takes the next tick; `tip` (mm) is where the device truly was when it was read.
    void add(const TickResult& result, const Eigen::Vector3d& tip);

    const ForceFigures& figures() const { return figures_; }

  private:
    double pull_of(const Contact& contact, const TickResult& result) const;
    void count_energy(const Eigen::Vector3d& force, const Eigen::Vector3d& tip);

    const RestNormals& normals_;
    const haptics::HapticModel& model_;
    Passivity passivity_;
    ForceFigures figures_;
    bool first_ = true, in_episode_ = false, over_ = false;
    Eigen::Vector3d last_wanted_ = Eigen::Vector3d::Zero(), last_force_ = Eigen::Vector3d::Zero(),
                    last_tip_ = Eigen::Vector3d::Zero();
    double episode_given_ = 0, episode_bound_ = 0;
};

}  // namespace palpate::experiments
