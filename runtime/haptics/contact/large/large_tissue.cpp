// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/large/large_tissue.hpp"

#include <algorithm>

namespace palpate::haptics {
namespace {

using Eigen::Index;
using Eigen::Vector3f;

constexpr double settled = 1e-4;  // mm: a step shorter than this ends the search
// A search has settled where another step would move tissue by less than that part of the largest
// displacement, which is what a surface may be off by a third of a second after the hand rests, or by so many
// mm.
constexpr double most_missing = 0.05, least_missing = 0.01;
constexpr int most_steps = 2;  // for an organ of 3 500 nodes most of a period: rest_search.cpp
// How much of a change of forces is taken, and how that changes where they swing and where they do not.
constexpr double least_taken = 0.2, most_taken = 0.7, slower = 0.5, faster = 1.25;
// Of its linear compliance, what a body keeps against a small force more: where it stiffens beyond that,
// part() is bent less.
constexpr double least_compliance = 0.3;

}  // namespace

LargeTissue::LargeTissue(const DeformableBody& body, const DeformableContact& contact)
    : equilibrium_(body),
      contact_(contact),
      loads_(Eigen::VectorXd::Zero(equilibrium_.mesh().dofs())),
      changes_(loads_),
      last_changes_(loads_),
      linear_(body.boundary.nodes.size(), Vector3f::Zero()),
      answered_(linear_) {
    for (const std::int32_t node : body.boundary.nodes)
        places_.push_back(equilibrium_.mesh().positions()[static_cast<std::size_t>(node)]);
    reset();
}

void LargeTissue::reset() noexcept {
    equilibrium_.reset();
    loads_.setZero();
    last_changes_.setZero();
    taken_ = most_taken;
    std::ranges::fill(linear_, Vector3f::Zero());
}

// Forces and shapes answer each other, and would swing where tissue under load gives way twice as much as at
// rest: so of what forces changed by a part is taken, less as soon as they swing.
void LargeTissue::take(std::span<const SurfaceForce> forces) noexcept {
    changes_ = -loads_;
    contact_.each_load(forces, [&](std::int32_t vertex, const Vector3f& force) {
        if (const std::int32_t place = places_[static_cast<std::size_t>(vertex)]; place >= 0)
            changes_.segment<3>(3 * Index{place}) += force.cast<double>();
    });
    const bool swings = changes_.dot(last_changes_) < 0;
    taken_ = std::clamp(taken_ * (swings ? slower : faster), least_taken, most_taken);
    loads_ += taken_ * changes_;
    last_changes_.swap(changes_);
    contact_.displace(forces, answered_);
    for (std::size_t v = 0; v < places_.size(); ++v)
        linear_[v] += static_cast<float>(taken_) * (answered_[v] - linear_[v]);
}

void LargeTissue::follow(std::span<const SurfaceForce> forces, LargeShape& shape) noexcept {
    if (!forces.empty()) take(forces);
    // What is no number must not stay.
    if (forces.empty() || !loads_.allFinite()) {
        shape.reset(places_.size());
        return reset();
    }
    const double missing = equilibrium_.approach(loads_, settled, most_steps);
    const Eigen::VectorXd& moved = equilibrium_.displacements();
    shape.settled = missing <= std::max(least_missing, most_missing * moved.lpNorm<Eigen::Infinity>());
    double linear_work = 0;
    for (std::size_t v = 0; v < places_.size(); ++v) {
        shape.drawn[v].setZero();
        if (places_[v] < 0) continue;
        shape.drawn[v] = moved.segment<3>(3 * Index{places_[v]}).cast<float>() - linear_[v];
        linear_work += loads_.segment<3>(3 * Index{places_[v]}).dot(linear_[v].cast<double>());
    }
    contact_.average(shape.drawn, shape.beyond);
    for (std::size_t v = 0; v < places_.size(); ++v) answered_[v] = linear_[v] + shape.drawn[v];
    contact_.average(answered_, shape.moved);
    shape.work = loads_.dot(moved);
    // By so much of its linear compliance it has stiffened.
    const double stiffened = linear_work > 0 ? 1 - shape.work / linear_work : 0;
    shape.bend = stiffened > 0 ? std::clamp((1 - least_compliance) / stiffened - 1, 0.0, 1.0) : 1;
}

}  // namespace palpate::haptics
