// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "runtime/collision/collision_surface.hpp"

namespace palpate::collision {

/// A distance field at a point.
struct FieldSample {
    double distance = 0;                                 ///< mm, > 0 outside
    Eigen::Vector3d gradient = Eigen::Vector3d::Zero();  ///< of the interpolant, per mm; not normalised
};

/// The signed distance to a closed surface, d(p) > 0 outside, sampled on a grid near the surface, for points
/// of a tool that ask for it by the thousand at 1 kHz. Of the grid only bricks of 8 x 8 x 8 cells are stored
/// that come within `band` of the surface; each has all samples of its cells, so that a query reads one
/// brick. What is stored is clamp(d, -band, band), exact up to float32, which also rounds `band`. All queries
/// are noexcept, thread-safe and realtime-safe. Source: Barbic, James 2008, "Six-DoF haptic rendering of
/// contact between geometrically complex reduced deformable models"; McNeely, Puterbaugh, Troy 1999.
class DistanceField {
  public:
    /// The most bytes of samples, and the most bricks of the grid, stored or not.
    static constexpr double most_bytes = 0x1p30, most_bricks = 0x1p24;

    /// Samples the distance every `voxel` mm within `band` mm of the surface, on `threads` threads with the
    /// caller's; their number does not change a bit of it. The surface must bound a solid (unchecked): about
    /// a hole, or where it crosses itself, sides are any and jump; distances hold. Throws InvalidInput if
    /// voxel or band is not positive, if the band is below a voxel's diagonal, sqrt(3) voxel, so that cells
    /// which the surface crosses would be clamped, or, before it samples, if there were more than most_bytes
    /// or most_bricks; it names a voxel within that limit. Cost: a nearest point per sample, some 2 area
    /// (band + 4 voxel) / voxel^3 of them, and for a while twice the memory.
    DistanceField(const CollisionSurface& surface, double voxel, double band, std::size_t threads);

    /// The trilinear interpolant of the samples at p_P (mm), and its gradient, which is that of `distance`
    /// and so makes forces conservative; on a face between cells it is that of the upper cell. The
    /// interpolant is continuous, within error() of clamp(d, -band, band), and so has the sign of d where |d|
    /// > error(). A cell whose corners are all farther from the surface than the band is +band outside and
    /// -band inside, with zero gradient; beyond the grid it is +band, also where p is no number. Cost: one
    /// brick, some 20 ns where it is in the cache.
    FieldSample at(const Eigen::Vector3d& p) const noexcept;

    /// A lower bound of |d(p)|, mm: nothing that moves less than this meets the surface. Near the surface
    /// |at(p)| - error(), or 0; far from it, by the nearest point of the brick's centre c: |d(c)| - |p - c|;
    /// beyond the grid the distance to the surface's bounding box. Costs what at() does.
    double clearance(const Eigen::Vector3d& p) const noexcept;

    /// sqrt(3) / 2 voxel, mm: d changes by at most the way, so that the interpolant at p is off by at most
    /// sum w_i |p - p_i| <= sqrt(sum w_i |p - p_i|^2) over the corners p_i of its cell and their weights w_i,
    /// and the last is voxel * sqrt(sum f (1 - f)) over the three coordinates f of p in the cell.
    double error() const noexcept;

    double voxel() const noexcept { return voxel_; }
    double band() const noexcept { return band_; }
    /// p_P of the first sample, mm; sample i lies at origin + i * voxel.
    const Eigen::Vector3d& origin() const noexcept { return origin_; }
    /// The grid's cells along x, y and z.
    Eigen::Vector3i cells() const noexcept { return bricks_ * brick_cells; }
    /// What is stored, in bytes.
    std::size_t bytes() const noexcept {
        return samples_.size() * sizeof(float) + places_.size() * sizeof(Place);
    }

  private:
    static constexpr std::int32_t brick_cells = 8, brick_samples = brick_cells + 1;
    static constexpr std::size_t samples_of_a_brick =
        std::size_t{brick_samples} * brick_samples * brick_samples;
    static constexpr std::int32_t all_outside = -1, all_inside = -2;

    // Of every brick of the grid, x first.
    struct Place {
        std::int32_t brick;  // where its samples are, or on which side all of it lies
        float free_radius;   // mm: no surface is nearer to its centre; rounded down
    };
    struct Cell;

    void span_grid(const CollisionSurface& surface);
    void survey_row(const CollisionSurface& surface, std::size_t row);
    std::vector<Eigen::Vector3i> number_bricks_near();
    void sample_brick(const CollisionSurface& surface, const Eigen::Vector3i& brick);
    void copy_upper_faces(const Eigen::Vector3i& brick);
    void drop_clamped(const std::vector<Eigen::Vector3i>& near);
    Eigen::Vector3d corner_of(const Eigen::Vector3i& brick) const noexcept;
    float* samples_of(std::int32_t brick) noexcept;
    double far_distance(std::int32_t side) const noexcept { return side == all_outside ? band_ : -band_; }
    std::size_t place_of(const Eigen::Vector3i& brick) const noexcept {
        return static_cast<std::size_t>(brick[0] + bricks_[0] * (brick[1] + bricks_[1] * brick[2]));
    }
    static std::size_t in_brick(std::int32_t x, std::int32_t y, std::int32_t z) noexcept {
        return static_cast<std::size_t>(x + brick_samples * (y + brick_samples * z));
    }
    bool find_cell(const Eigen::Vector3d& p, Cell& cell) const noexcept;
    FieldSample interpolate(const Cell& cell) const noexcept;

    double voxel_, per_voxel_, band_;
    Eigen::Vector3d origin_, low_, high_;  // p_P, mm; low_, high_: the surface's box
    Eigen::Vector3i bricks_;               // along x, y and z
    std::vector<Place> places_;
    std::vector<float> samples_;  // brick by brick, x first
};

}  // namespace palpate::collision
