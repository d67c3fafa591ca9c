// SPDX-License-Identifier: Apache-2.0
// What the search for an equilibrium allocates before the first tick.
#include <algorithm>
#include <cmath>
#include <limits>

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
      held_moved_(most_vertices),
      seen_(most_vertices),
      sum_(most_vertices),
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

double nearest_beside(std::span<const ToolSphere> spheres, std::size_t to) {
    double nearest = std::numeric_limits<double>::infinity();
    for (std::size_t k = 0; k < spheres.size(); ++k)
        if (k != to) nearest = std::min(nearest, apart_on_a_plane(spheres[k], spheres[to]));
    return nearest;
}

}  // namespace

ContactEquilibrium::ContactEquilibrium(const ContactBodies& bodies, std::span<const ToolSphere> spheres,
                                       const Friction& friction, std::size_t tool_count)
    : bodies_(bodies), friction_(friction), neighbours_(bodies) {
    for (const DeformableContact& body : bodies.deformable) {
        patches_.emplace_back(body);
        visited_.emplace_back(body.triangle_count(), 0U);
    }
    Tool tool;
    for (std::size_t k = 0; k < spheres.size(); ++k) {
        Part& part = tool.parts.emplace_back();
        part.radius = spheres[k].radius;
        part.touches.resize(patches_.size());
        for (std::size_t soft = 0; soft < patches_.size(); ++soft)
            if (const LoadSpread* spread = patches_[soft].body().spread())
                part.touches[soft].least_slope = least_slope_beside(
                    nearest_beside(spheres, k), spread->contact_modulus(), spread->radius());
    }
    for (const DeformedPatch& patch : patches_) {
        const LoadSpread* spread = patch.body().spread();
        beside_.push_back(spread ? indentations_beside(spheres, *spread) : Eigen::MatrixXd{});
    }
    tools_.assign(tool_count, tool);
}

ContactEquilibrium::~ContactEquilibrium() = default;

}  // namespace palpate::haptics
