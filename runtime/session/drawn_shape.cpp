// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/drawn_shape.hpp"

namespace palpate::session {

DrawnShape::DrawnShape(const Case& patient_case, const haptics::HapticModel& model) : model_(model) {
    if (model.method().can.creeps)
        for (const DeformableBody& body : patient_case.deformable_bodies) creep_.emplace_back(body);
}

void DrawnShape::follow(std::span<const TickResult* const> ticks,
                        std::span<std::vector<Eigen::Vector3f>> displacements) {
    for (std::size_t i = 0; i < displacements.size(); ++i) {
        const std::size_t body = model_.rigid_count() + i;
        model_.surface_displacement(body, *ticks.front(), displacements[i]);
        of_one_tool_.resize(displacements[i].size());
        for (const TickResult* other : ticks.subspan(1)) {
            model_.surface_displacement(body, *other, of_one_tool_);
            for (std::size_t v = 0; v < of_one_tool_.size(); ++v) displacements[i][v] += of_one_tool_[v];
        }
        if (!creep_.empty()) creep_[i].follow(ticks.front()->time, displacements[i]);
    }
}

}  // namespace palpate::session
