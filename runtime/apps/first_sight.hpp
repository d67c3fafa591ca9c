// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/visual/inside/passage_sight.hpp"
#include "runtime/visual/sight.hpp"

namespace palpate::apps {

/// The rest surfaces of a model's bodies, which it owns.
inline std::vector<const collision::CollisionSurface*> surfaces_of(const haptics::HapticModel& model) {
    std::vector<const collision::CollisionSurface*> surfaces;
    for (std::size_t body = 0; body < model.body_count(); ++body) surfaces.push_back(&model.surface(body));
    return surfaces;
}

/// From where a place on a surface is seen first: from outside; where bodies stand between, from inside the
/// passage if there is one. See choose_sight() and choose_passage_sight().
inline visual::Sight first_sight(const Case& patient_case, const haptics::HapticModel& model,
                                 const Eigen::Vector3d& point, const Eigen::Vector3d& normal) {
    const visual::Sight outside = visual::choose_sight(patient_case, point, normal);
    if (!outside.blocked) return outside;
    return visual::choose_passage_sight(surfaces_of(model), point, normal).value_or(outside);
}

}  // namespace palpate::apps
