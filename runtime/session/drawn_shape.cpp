// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/drawn_shape.hpp"

namespace palpate::session {

DrawnShape::DrawnShape(const Case& patient_case, const haptics::HapticModel& model) : model_(model) {
    if (model.method().can.creeps)
        for (const DeformableBody& body : patient_case.deformable_bodies) creep_.emplace_back(body);
}

void DrawnShape::follow(const TickResult& tick, std::span<std::vector<Eigen::Vector3f>> displacements) {
    for (std::size_t i = 0; i < displacements.size(); ++i) {
        model_.surface_displacement(model_.rigid_count() + i, tick, displacements[i]);
        if (!creep_.empty()) creep_[i].follow(tick.time, displacements[i]);
    }
}

}  // namespace palpate::session
