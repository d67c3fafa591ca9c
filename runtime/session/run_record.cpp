// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/run_record.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <limits>
#include <ostream>

#include "formats/model/arrays.hpp"

namespace palpate::session {
namespace {

using Eigen::Vector3d;
using haptics::HapticModel;

// RFC 4180: a field with a comma, quote or line break stands in quotes.
std::string csv_field(const std::string& text) {
    if (text.find_first_of(",\"\r\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char c : text) quoted += c == '"' ? "\"\"" : std::string(1, c);
    return quoted + '"';
}

}  // namespace

void write_log_head(std::ostream& log) {
    log << "t_s,device_x_mm,device_y_mm,device_z_mm,tool_x_mm,tool_y_mm,tool_z_mm,force_x_n,force_y_n,"
           "force_z_n,depth_mm,contacts,body,triangle,tick_us,wake_us,status,tool,"
           "faults,torque_x_n_mm,torque_y_n_mm,torque_z_n_mm,device_qx,device_qy,device_qz,device_qw,"
           "tool_qx,tool_qy,tool_qz,tool_qw\n";
}

RunRecord::RunRecord(const HapticModel& model, std::ostream* log) : model_(model), log_(log) {
    spheres_.assign(model.tool_spheres().begin(), model.tool_spheres().end());
    if (spheres_.empty()) spheres_.push_back({Vector3d::Zero(), model.contact_radius()});
    clearances_.resize(spheres_.size() * model.rigid_count());
}

void RunRecord::add(const TickResult& result) {
    const double force = vector_of(result.force).norm();
    if (last_tick_ == no_tick || force > peak_force()) peak_ = result;
    curve_.add({result.time, force, result.depth});
    if (result.tick == last_tick_ + 1)
        largest_force_step_ =
            std::max(largest_force_step_, (vector_of(result.force) - vector_of(last_force_)).norm());
    last_force_ = result.force;
    peak_torque_ = std::max(peak_torque_, vector_of(result.torque).norm());
    last_tick_ = result.tick;
    device_depth_ = std::max(device_depth_, result.depth);
    tool_depth_ = std::max(tool_depth_, tool_depth_of(result));
    statuses_.add(result);
    if (log_) write_row(result);
}

double RunRecord::peak_force() const {
    return vector_of(peak_.force).norm();
}

double RunRecord::tool_depth_of(const TickResult& result) {
    if ((result.status & starts_inside) || (result.faults & distrusted_position)) return 0;
    double depth = result.residual;
    if (model_.method().can.always_turns) return depth;  // that of its deepest point
    const Vector3d tool = vector_of(result.tool_position);
    const Eigen::Quaterniond turned = quaternion_of(result.tool_orientation);
    // How a tool is turned is told where it turns by itself.
    const bool turns = !turned.coeffs().isZero(0);
    for (std::size_t s = 0; s < (turns ? spheres_.size() : 1); ++s) {
        const auto& [place, radius] = spheres_[s];
        const Vector3d centre = turns ? Vector3d(tool + turned * place) : tool;
        for (std::size_t body = 0; body < model_.rigid_count(); ++body)
            depth =
                std::max(depth, depth_in(body, centre, radius, clearances_[s * model_.rigid_count() + body]));
    }
    return depth;
}

// How deep a sphere is in a rigid body; below zero or not looked at where it is clear of it.
double RunRecord::depth_in(std::size_t body, const Vector3d& centre, double radius, Clearance& last) const {
    if (last.outside - (centre - last.at).norm() > radius) return 0;
    const collision::CollisionSurface& surface = model_.surface(body);
    const auto nearest = surface.closest_point(centre, std::numeric_limits<double>::max(), last.hint);
    if (!nearest) return 0;
    last = {centre, surface.is_outside(centre, *nearest) ? nearest->distance : -nearest->distance,
            nearest->slot};
    return radius - last.outside;
}

void RunRecord::write_row(const TickResult& r) {
    const auto& d = r.device_position;
    const auto& t = r.tool_position;
    const auto& f = r.force;
    const auto &held = r.orientation, &turned = r.tool_orientation;
    fmt::memory_buffer row;
    fmt::format_to(
        std::back_inserter(row),
        "{:.3f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.4f},{:.5f},{:.5f},{:.5f},{:.4f},{},{},{},{:.2f},"
        "{:.2f},{},{},{},{:.3f},{:.3f},{:.3f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f},{:.6f}\n",
        r.time, d[0], d[1], d[2], t[0], t[1], t[2], f[0], f[1], f[2], r.depth, r.contact_count,
        r.body < 0 ? "" : csv_field(model_.body_name(static_cast<std::size_t>(r.body))),
        r.contact_count > 0 ? r.contacts[0].triangle : -1, 1e-3 * static_cast<double>(r.tick_ns),
        1e-3 * static_cast<double>(r.wake_latency_ns), status_text(r.status), r.tool, fault_names(r.faults),
        r.torque[0], r.torque[1], r.torque[2], held[0], held[1], held[2], held[3], turned[0], turned[1],
        turned[2], turned[3]);
    log_->write(row.data(), static_cast<std::streamsize>(row.size()));
}

}  // namespace palpate::session
