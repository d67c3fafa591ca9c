// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/tetrahedra/size_field.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::meshing {
namespace {

void lower(LocalSizes& sizes, const LocalSizes& bounds) {
    sizes.cell = std::min(sizes.cell, bounds.cell);
    sizes.facet = std::min(sizes.facet, bounds.facet);
    sizes.distance = std::min(sizes.distance, bounds.distance);
}

}  // namespace

SizeField::SizeField(std::span<const LocalSizes> regions, double lattice_edge)
    : regions_(regions.begin(), regions.end()), lattice_edge_(lattice_edge) {}

std::array<int, 3> SizeField::lattice_cell(const Eigen::Vector3d& p_P) const {
    std::array<int, 3> cell{};
    for (std::size_t axis = 0; axis < 3; ++axis)
        cell[axis] = static_cast<int>(std::floor(p_P[static_cast<Eigen::Index>(axis)] / lattice_edge_));
    return cell;
}

void SizeField::add(const FineBall& ball) {
    const Eigen::Vector3d reach = Eigen::Vector3d::Constant(ball.radius);
    const auto low = lattice_cell(ball.center - reach), high = lattice_cell(ball.center + reach);
    for (int k = low[2]; k <= high[2]; ++k)
        for (int j = low[1]; j <= high[1]; ++j)
            for (int i = low[0]; i <= high[0]; ++i)
                balls_near_[{i, j, k}].push_back(static_cast<std::uint32_t>(balls_.size()));
    balls_.push_back(ball);
}

double SizeField::finest_distance() const {
    LocalSizes finest;
    for (const LocalSizes& region : regions_) lower(finest, region);
    for (const FineBall& ball : balls_) lower(finest, ball.sizes);
    return finest.distance;
}

double SizeField::largest_facet() const {
    return std::ranges::max_element(regions_, {}, &LocalSizes::facet)->facet;
}

LocalSizes SizeField::at(const Eigen::Vector3d& p_P, int region, int other) const {
    LocalSizes sizes;
    for (const int side : {region, other})
        if (side > 0) lower(sizes, regions_[static_cast<std::size_t>(side) - 1]);
    if (balls_.empty()) return sizes;
    const auto near = balls_near_.find(lattice_cell(p_P));
    if (near == balls_near_.end()) return sizes;
    for (const std::uint32_t number : near->second) {
        const FineBall& ball = balls_[number];
        if ((p_P - ball.center).squaredNorm() <= ball.radius * ball.radius) lower(sizes, ball.sizes);
    }
    return sizes;
}

}  // namespace palpate::meshing
