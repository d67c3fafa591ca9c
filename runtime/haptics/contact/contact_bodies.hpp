// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <memory>
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "runtime/haptics/contact/deformable_contact.hpp"

namespace palpate::haptics {

/// The bodies of a case as every contact method finds them: rigid ones first, then deformable ones.
struct ContactBodies {
    /// Copies what it needs of the case; compliances are shared. Throws InvalidInput if surface, tree and
    /// compliance of a body do not belong together. Linear in the surfaces.
    explicit ContactBodies(const Case& patient_case, bool spreads_loads);

    std::size_t rigid_count() const noexcept { return surfaces.size() - deformable.size(); }

    std::vector<std::string> names;
    std::vector<std::unique_ptr<collision::CollisionSurface>> surfaces;  ///< at rest
    std::vector<std::vector<Triangle>> triangles;                        ///< surface vertices
    std::vector<DeformableContact> deformable;  ///< of the deformable bodies, in their order
};

}  // namespace palpate::haptics
