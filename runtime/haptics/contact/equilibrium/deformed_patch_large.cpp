// SPDX-License-Identifier: Apache-2.0
// Tissue that leans on a shape of large deformation; part of the tick.
//
// Such a shape says where hyperelastic tissue has come to rest, or is about to, under forces f* that follow
// those of the ticks: u*. A tick answers its forces f by u = C f + s (u* - C f*), s a function of the part p
// of f* that f has, s(1) = 1. So where the hand rests, and f* comes to f, u comes to the hyperelastic answer,
// whatever s is; s makes what changes meanwhile right to the second order. It is counted as held: p is that
// of the tick before, smoothed so that the one cannot swing about the other. A new shape comes in over some
// ticks.
#include <algorithm>

#include "runtime/haptics/contact/equilibrium/deformed_patch.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

constexpr int ticks_to_lean = 5;
constexpr double newest = 0.5;  // of the part of the load that counts, what the last tick says

}  // namespace

void DeformedPatch::take_shape(const LargeShape* shape) noexcept {
    shape_ = shape;
    load_ = shape == nullptr ? 0 : load();
    leaning_ticks_ = 0;
    std::copy_n(leans_.begin(), size_, leant_.begin());
}

double DeformedPatch::load() const noexcept {
    double along = 0;
    each_force([&](std::int32_t vertex, const Vector3d& force) {
        along += force.dot(shape_->moved[static_cast<std::size_t>(vertex)].cast<double>());
    });
    return shape_->load_of(along);
}

void DeformedPatch::lean() noexcept {
    load_ += newest * (load() - load_);
    part_ = shape_->part(load_);
    leaning_ticks_ = std::min(leaning_ticks_ + 1, ticks_to_lean);
    const double come = static_cast<double>(leaning_ticks_) / ticks_to_lean;
    for (std::int32_t slot = 0; slot < size_; ++slot) {
        const Vector3d leans = (1 - come) * leant_[slot] + come * beyond_at(vertices_[slot]);
        add_lasting(slot, leans - leans_[slot]);
        leans_[slot] = leans;
    }
}

}  // namespace palpate::haptics
