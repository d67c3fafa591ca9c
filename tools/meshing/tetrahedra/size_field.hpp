// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <limits>
#include <map>
#include <span>
#include <vector>

namespace palpate::meshing {

/// Upper bounds of a mesh's sizes, mm: circumradius of a tetrahedron and of a surface triangle, and distance
/// of a surface triangle to the surface.
struct LocalSizes {
    double cell = std::numeric_limits<double>::infinity();
    double facet = std::numeric_limits<double>::infinity();
    double distance = std::numeric_limits<double>::infinity();
};

/// Sizes for a ball, where they are smaller than those around it.
struct FineBall {
    Eigen::Vector3d center;  ///< p_P, mm
    double radius;           ///< mm
    LocalSizes sizes;
};

/// The sizes wanted at every point: those of the region, or less inside balls.
class SizeField {
  public:
    /// `regions[k]` belongs to region k + 1. Balls are found through a lattice of `lattice_edge` mm, which
    /// should be about their radius.
    SizeField(std::span<const LocalSizes> regions, double lattice_edge);

    void add(const FineBall& ball);

    /// Sizes at p_P in a region, or on the interface of two, where the finer holds; region 0 has none of its
    /// own. Thread-safe while nothing is added.
    LocalSizes at(const Eigen::Vector3d& p_P, int region, int other = 0) const;

    /// The smallest distance bound anywhere.
    double finest_distance() const;

    /// The largest facet size of a region.
    double largest_facet() const;

  private:
    std::array<int, 3> lattice_cell(const Eigen::Vector3d& p_P) const;

    std::vector<LocalSizes> regions_;
    double lattice_edge_;
    std::vector<FineBall> balls_;
    std::map<std::array<int, 3>, std::vector<std::uint32_t>> balls_near_;
};

}  // namespace palpate::meshing
