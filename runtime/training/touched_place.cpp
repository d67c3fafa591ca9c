// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/touched_place.hpp"

#include "runtime/session/touch_target.hpp"

namespace palpate::training {

using Eigen::Vector3d;

std::optional<Vector3d> touched_place(const Case& patient_case, const TickResult& tick) {
    Vector3d sum = Vector3d::Zero();
    double weight = 0;
    for (const Contact& contact : tick.active_contacts()) {
        if (is_of_neighbour(contact) || contact.force <= 0) continue;
        const TriangleMesh& surface =
            session::surface_of(patient_case, static_cast<std::size_t>(contact.body));
        Vector3d point = Vector3d::Zero();
        for (std::size_t corner = 0; corner < 3; ++corner)
            if (contact.vertices[corner] >= 0)
                point += contact.weights[corner] * surface.vertices[contact.vertices[corner]];
        sum += contact.force * point;
        weight += contact.force;
    }
    if (weight <= 0) return std::nullopt;
    return sum / weight;
}

}  // namespace palpate::training
