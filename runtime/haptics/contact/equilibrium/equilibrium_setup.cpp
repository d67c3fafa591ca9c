// SPDX-License-Identifier: Apache-2.0
// What the search for an equilibrium allocates before the first tick.
#include <algorithm>
#include <cmath>

#include "formats/model/contact/local_indentation.hpp"
#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {

DeformedPatch::DeformedPatch(const DeformableContact& body)
    : body_(&body),
      slots_(body.vertex_count(), no_slot),
      vertices_(most_vertices),
      rest_(most_vertices),
      moved_(most_vertices),
      before_(most_vertices),
      measured_(most_vertices),
      held_moved_(most_vertices),
      seen_(most_vertices),
      sum_(most_vertices),
      way_(most_vertices),
      blocks_(static_cast<std::size_t>(most_vertices * most_vertices)),
      forces_(most_vertices),
      held_(most_vertices),
      answers_(iterates, Answer(most_vertices)),
      leans_(most_vertices, Eigen::Vector3d::Zero()),
      leant_(most_vertices, Eigen::Vector3d::Zero()),
      creeps_as_(most_vertices),
      left_forces_(most_vertices),
      left_moves_(most_vertices),
      lasting_(most_vertices, Eigen::Vector3d::Zero()) {}

namespace {

// How far from each other two spheres touch a plane that both touch, mm.
double apart_on_a_plane(const ToolSphere& a, const ToolSphere& b) {
    const double higher = a.radius - b.radius;
    return std::sqrt(std::max(0.0, (a.centre - b.centre).squaredNorm() - higher * higher));
}

Eigen::MatrixXd indentations_beside(std::span<const ToolSphere> spheres, const LoadSpread& spread) {
    const auto n = static_cast<Eigen::Index>(spheres.size());
    Eigen::MatrixXd beside = Eigen::MatrixXd::Zero(n, n);
    for (Eigen::Index k = 0; k < n; ++k)
        for (Eigen::Index l = 0; l < k; ++l)
            beside(k, l) = beside(l, k) = indentation_beside(
                apart_on_a_plane(spheres[static_cast<std::size_t>(k)], spheres[static_cast<std::size_t>(l)]),
                spread.contact_modulus(), spread.radius());
    return beside;
}

}  // namespace

ContactEquilibrium::ContactEquilibrium(const ContactBodies& bodies, std::span<const ToolSphere> spheres,
                                       bool are_one_surface, const Friction& friction, std::size_t tool_count)
    : bodies_(bodies), friction_(friction), neighbours_(bodies), are_one_surface_(are_one_surface) {
    for (const DeformableContact& body : bodies.deformable) {
        patches_.emplace_back(body);
        visited_.emplace_back(body.triangle_count(), 0U);
    }
    Tool tool;
    for (const ToolSphere& sphere : spheres) {
        tool.parts.emplace_back().radius = sphere.radius;
        tool.parts.back().touches.resize(patches_.size());
        tool.parts.back().holds.resize(patches_.size() + 1);
    }
    for (const DeformedPatch& patch : patches_) {
        const LoadSpread* spread = are_one_surface ? patch.body().spread() : nullptr;
        beside_.push_back(spread ? indentations_beside(spheres, *spread) : Eigen::MatrixXd{});
    }
    tools_.assign(tool_count, tool);
}

ContactEquilibrium::~ContactEquilibrium() = default;

}  // namespace palpate::haptics
