// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <iosfwd>
#include <limits>
#include <vector>

#include "formats/records/status_counts.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/session/force_curve.hpp"

namespace palpate::session {

/// Writes the first row of a log: the names of the columns that RunRecord writes.
void write_log_head(std::ostream& log);

/// What a run leaves behind of one tool, gathered from its ticks outside the haptic thread.
class RunRecord {
  public:
    /// Writes one CSV row per tick to `log` if it is not null. Model and stream must outlive the record.
    RunRecord(const haptics::HapticModel& model, std::ostream* log);

    void add(const TickResult& result);

    std::vector<CurvePoint> curve() const { return curve_.points(); }
    const TickResult& peak() const { return peak_; }       ///< the tick with the largest force
    double peak_force() const;                             ///< N
    double peak_torque() const { return peak_torque_; }    ///< N mm
    double device_depth() const { return device_depth_; }  ///< deepest below any rest surface, mm
    /// Deepest that the tool went below a surface it touched: below a rigid one its tip, or the spheres that
    /// stand for one that turns by itself; or what the contact solver left of a deformable one, mm.
    double tool_depth() const { return tool_depth_; }
    double largest_force_step() const { return largest_force_step_; }  ///< N between successive ticks
    /// How many ticks had each flag of TickStatus.
    const StatusCounts& statuses() const { return statuses_; }

  private:
    // Where a sphere was when it was held against a rigid body, and how far its centre is outside of that.
    struct Clearance {
        Eigen::Vector3d at{0, 0, 0};                                // mm
        double outside = -std::numeric_limits<double>::infinity();  // mm
        std::int32_t hint = -1;                                     // of the surface
    };

    void write_row(const TickResult& result);
    double tool_depth_of(const TickResult& result);
    double depth_in(std::size_t body, const Eigen::Vector3d& centre, double radius, Clearance& last) const;

    const haptics::HapticModel& model_;
    std::ostream* log_;
    std::vector<haptics::ToolSphere> spheres_;  // what is looked at of the tool, its tip first
    std::vector<Clearance> clearances_;         // by sphere and rigid body
    ForceCurve curve_;
    TickResult peak_{};
    std::array<double, 3> last_force_{0, 0, 0};
    static constexpr std::int64_t no_tick = -2;  // nor before the first
    std::int64_t last_tick_ = no_tick;
    double peak_torque_ = 0;
    double device_depth_ = 0;
    double tool_depth_ = 0;
    double largest_force_step_ = 0;
    StatusCounts statuses_;
};

}  // namespace palpate::session
