// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/drawn_shape.hpp"

#include <algorithm>

namespace palpate::session {

DrawnShape::DrawnShape(const Case& patient_case, bool deforms_far) : deforms_far_(deforms_far) {
    for (const DeformableBody& body : patient_case.deformable_bodies) creep_.emplace_back(body);
}

void DrawnShape::follow(const haptics::HapticModel& model, double time,
                        std::span<const TickResult* const> ticks,
                        std::span<std::vector<Eigen::Vector3f>> displacements) {
    for (std::size_t i = 0; i < displacements.size(); ++i) {
        std::ranges::fill(displacements[i], Eigen::Vector3f::Zero());
        of_one_tool_.resize(displacements[i].size());
        for (const TickResult* tick : ticks) {
            if (tick->contact_count == 0) continue;
            model.surface_displacement(model.rigid_count() + i, *tick, of_one_tool_);
            for (std::size_t v = 0; v < of_one_tool_.size(); ++v) displacements[i][v] += of_one_tool_[v];
        }
        if (model.method().can.creeps) creep_[i].follow(time, displacements[i]);
        if (deforms_far_) model.add_beyond(model.rigid_count() + i, ticks, displacements[i]);
    }
}

}  // namespace palpate::session
