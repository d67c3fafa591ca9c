// SPDX-License-Identifier: Apache-2.0
#include "runtime/collision/field/distance_field.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <atomic>
#include <cmath>
#include <limits>
#include <numbers>
#include <string>
#include <thread>

#include "formats/model/errors.hpp"

namespace palpate::collision {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3i;

// mm: far above what a distance in double is off, far below what matters.
constexpr double double_error = 1e-9;

// Signed distances along a chain of points, each near the one before.
class DistanceChain {
  public:
    explicit DistanceChain(const CollisionSurface& surface) : surface_(surface) {}

    // clamp(d(p), -limit, limit). Two balls without surface that overlap are on one side of it: only where
    // they do not is it asked which.
    double next(const Vector3d& p, double limit) {
        const auto nearest = surface_.closest_point(p, limit, hint_);
        const double free = nearest ? nearest->distance : limit;
        if (!(free + last_free_ > (p - last_).norm() + double_error))
            outside_ = nearest ? surface_.is_outside(p, *nearest) : surface_.is_outside(p);
        if (nearest) hint_ = nearest->slot;
        last_ = p;
        last_free_ = free;
        return outside_ ? free : -free;
    }

  private:
    const CollisionSurface& surface_;
    std::int32_t hint_ = -1;
    Vector3d last_ = Vector3d::Zero();
    double last_free_ = -std::numeric_limits<double>::infinity();
    bool outside_ = true;
};

// Calls work(i) for each i < count, in any order, on as many threads as are asked for.
void share_out(std::size_t count, std::size_t threads, const auto& work) {
    std::atomic<std::size_t> next = 0;
    const auto take_turns = [&] {
        for (std::size_t i = next++; i < count; i = next++) work(i);
    };
    std::vector<std::jthread> others;
    for (std::size_t i = 1; i < std::min(threads, count); ++i) others.emplace_back(take_turns);
    take_turns();
}

[[noreturn]] void refuse(const std::string& found, const std::string& expected, double voxel_that_fits) {
    throw InvalidInput({.culprit = "distance field",
                        .found = found,
                        .expected = expected,
                        .next_step = "a voxel of " + std::to_string(voxel_that_fits) + " mm fits"});
}

std::string whole(double number) {
    const std::string digits = std::to_string(number);
    return digits.substr(0, digits.find('.'));
}

void check_lengths(double voxel, double band) {
    for (const double length : {voxel, band})
        if (const auto stored = static_cast<float>(length); !(std::isfinite(stored) && stored > 0))
            throw InvalidInput({"distance field", std::to_string(length) + " mm", "a positive length", ""});
    if (band < std::numbers::sqrt3 * voxel)
        refuse("a band of " + std::to_string(band) + " mm", "at least a voxel's diagonal",
               0.99 * band / std::numbers::sqrt3);
}

// What there is of bricks falls at least with the square of the voxel: with its cube, while what the bricks
// near the surface cover grows with it.
void check_size(double found, double most, const std::string& what, double voxel) {
    if (found > most)
        refuse(whole(found) + what, "at most " + whole(most), 1.01 * voxel * std::sqrt(found / most));
}

}  // namespace

DistanceField::DistanceField(const CollisionSurface& surface, double voxel, double band, std::size_t threads)
    : voxel_(voxel), per_voxel_(1 / voxel), band_(static_cast<float>(band)) {
    check_lengths(voxel, band);
    span_grid(surface);
    const auto rows = static_cast<std::size_t>(bricks_[1]) * static_cast<std::size_t>(bricks_[2]);
    share_out(rows, threads, [&](std::size_t row) { survey_row(surface, row); });
    const std::vector<Vector3i> near = number_bricks_near();
    share_out(near.size(), threads, [&](std::size_t i) { sample_brick(surface, near[i]); });
    share_out(near.size(), threads, [&](std::size_t i) { copy_upper_faces(near[i]); });
    drop_clamped(near);
}

// The surface's box, band and a voxel more on every side, so that the outermost samples are all +band.
void DistanceField::span_grid(const CollisionSurface& surface) {
    Eigen::AlignedBox3d box;
    for (std::int32_t slot = 0; slot < surface.triangle_count(); ++slot)
        for (const Vector3d& corner : surface.corners(slot)) box.extend(corner);
    low_ = box.min();
    high_ = box.max();
    const double beyond = band_ + voxel_, brick = brick_cells * voxel_;
    origin_ = low_.array() - beyond;
    const Vector3d bricks = ((box.sizes().array() + 2 * beyond) / brick).ceil();
    check_size(bricks.prod(), most_bricks, " bricks in its grid", voxel_);
    bricks_ = bricks.cast<std::int32_t>();
    places_.resize(static_cast<std::size_t>(bricks.prod()));
}

// How near the bricks of a row are, and on which side their centres.
void DistanceField::survey_row(const CollisionSurface& surface, std::size_t row) {
    const auto y = static_cast<std::int32_t>(row) % bricks_[1],
               z = static_cast<std::int32_t>(row) / bricks_[1];
    DistanceChain chain(surface);
    for (std::int32_t x = 0; x < bricks_[0]; ++x) {
        const Vector3d centre = corner_of({x, y, z}).array() + 0.5 * brick_cells * voxel_;
        const double distance = chain.next(centre, std::numeric_limits<double>::max());
        const auto nearest = static_cast<float>(std::abs(distance));
        places_[place_of({x, y, z})] = {distance > 0 ? all_outside : all_inside,
                                        std::nextafter(nearest, 0.0F)};
    }
}

// Sets room aside for the bricks that may hold a point within band of the surface.
std::vector<Vector3i> DistanceField::number_bricks_near() {
    const double reach = band_ + std::numbers::sqrt3 / 2 * brick_cells * voxel_;
    const auto is_near = [&](const Place& place) { return place.free_radius <= reach; };
    const auto count = static_cast<std::size_t>(std::ranges::count_if(places_, is_near));
    check_size(static_cast<double>(count * samples_of_a_brick * sizeof(float)), most_bytes, " bytes", voxel_);
    samples_.resize(count * samples_of_a_brick);
    std::vector<Vector3i> near;
    for (std::int32_t z = 0; z < bricks_[2]; ++z)
        for (std::int32_t y = 0; y < bricks_[1]; ++y)
            for (std::int32_t x = 0; x < bricks_[0]; ++x) {
                Place& place = places_[place_of({x, y, z})];
                if (!is_near(place)) continue;
                place.brick = static_cast<std::int32_t>(near.size());
                near.emplace_back(x, y, z);
            }
    return near;
}

// Samples what a brick does not share with later ones, there and back, so that each sample is next to the one
// before.
void DistanceField::sample_brick(const CollisionSurface& surface, const Vector3i& brick) {
    const auto turned = [](std::int32_t i, std::int32_t turn) { return turn % 2 ? brick_cells - 1 - i : i; };
    float* const samples = samples_of(places_[place_of(brick)].brick);
    const Vector3d corner = corner_of(brick);
    DistanceChain chain(surface);
    for (std::int32_t z = 0; z < brick_cells; ++z)
        for (std::int32_t j = 0; j < brick_cells; ++j)
            for (std::int32_t i = 0; i < brick_cells; ++i) {
                const std::int32_t y = turned(j, z), x = turned(i, j);
                const double distance = chain.next(corner + voxel_ * Vector3d(x, y, z), band_);
                samples[in_brick(x, y, z)] = static_cast<float>(distance);
            }
}

// Takes the samples on a brick's upper faces from its neighbours; where those have none, they are clamped.
void DistanceField::copy_upper_faces(const Vector3i& brick) {
    float* const samples = samples_of(places_[place_of(brick)].brick);
    for (std::int32_t z = 0; z < brick_samples; ++z)
        for (std::int32_t y = 0; y < brick_samples; ++y)
            for (std::int32_t x = 0; x < brick_samples; ++x) {
                const Vector3i over = Vector3i(x, y, z) / brick_cells;
                if (over.isZero()) continue;
                const Vector3i there = Vector3i(x, y, z) - brick_cells * over;
                const bool beyond = ((brick + over).array() == bricks_.array()).any();
                const std::int32_t owner = beyond ? all_outside : places_[place_of(brick + over)].brick;
                float& sample = samples[in_brick(x, y, z)];
                sample = static_cast<float>(far_distance(owner));
                if (owner >= 0) sample = samples_of(owner)[in_brick(there[0], there[1], there[2])];
            }
}

// Keeps the bricks with a sample within band and numbers them anew.
void DistanceField::drop_clamped(const std::vector<Vector3i>& near) {
    const auto clamped = [&](float sample) { return std::abs(sample) == static_cast<float>(band_); };
    std::int32_t kept = 0;
    for (const Vector3i& brick : near) {
        Place& place = places_[place_of(brick)];
        const float* const from = samples_of(place.brick);
        if (std::all_of(from, from + samples_of_a_brick, clamped)) {
            place.brick = *from > 0 ? all_outside : all_inside;
            continue;
        }
        std::copy(from, from + samples_of_a_brick, samples_of(kept));
        place.brick = kept++;
    }
    samples_.resize(static_cast<std::size_t>(kept) * samples_of_a_brick);
    samples_.shrink_to_fit();
}

float* DistanceField::samples_of(std::int32_t brick) noexcept {
    return samples_.data() + static_cast<std::size_t>(brick) * samples_of_a_brick;
}

Vector3d DistanceField::corner_of(const Vector3i& brick) const noexcept {
    return origin_ + voxel_ * (brick_cells * brick).cast<double>();
}

}  // namespace palpate::collision
