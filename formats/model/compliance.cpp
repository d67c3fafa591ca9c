// SPDX-License-Identifier: Apache-2.0
#include "formats/model/compliance.hpp"

#include <algorithm>
#include <array>
#include <cassert>

namespace palpate {
namespace {

using Eigen::Index;
using Rows = Eigen::Map<const Eigen::Matrix<float, 3, Eigen::Dynamic, Eigen::RowMajor>>;
using DenseRows = Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>, 0, Eigen::OuterStride<>>;

// The three rows of width `width` that belong to a node.
Rows rows_of(const float* values, std::int64_t node, Index width) noexcept {
    return {values + 3 * node * width, 3, width};
}

using Factors = const std::int16_t*;  // the three rows of a node's part of U or V, each of the block's rank

float dot(Factors row, const float* weights, std::int32_t rank) noexcept {
    std::array<float, 4> sums{};  // what one vector register takes
    for (std::int32_t k = 0; k < rank; k += 4)
        for (std::size_t lane = 0; lane < 4; ++lane)
            sums[lane] += static_cast<float>(row[static_cast<std::size_t>(k) + lane]) *
                          weights[static_cast<std::size_t>(k) + lane];
    return (sums[0] + sums[1]) + (sums[2] + sums[3]);
}

Eigen::Matrix3f block_of(const DenseCompliance& c, std::int32_t a, std::int32_t b) noexcept {
    return DenseRows(c.row(3 * static_cast<std::size_t>(a)) + 3 * static_cast<std::size_t>(b), 3, 3,
                     Eigen::OuterStride<>(static_cast<Index>(c.dof_count())));
}

void add_products(const DenseCompliance& c, std::span<const NodeForce> forces,
                  std::span<Eigen::Vector3f> displacements) noexcept {
    // C is symmetric: the column of a degree of freedom is its row, which lies in one piece.
    for (const NodeForce& load : forces)
        for (Index axis = 0; axis < 3; ++axis) {
            const float* row =
                c.row(3 * static_cast<std::size_t>(load.node) + static_cast<std::size_t>(axis));
            for (std::size_t node = 0; node < displacements.size(); ++node)
                displacements[node] += load.force[axis] * Eigen::Map<const Eigen::Vector3f>(row + 3 * node);
        }
}

// A block and the clusters that it couples.
struct Place {
    std::size_t block;
    std::int32_t level, row, column;
};

// Part (i, j) of a split block.
Place part(const HierarchicalCompliance& c, const Place& whole, std::int32_t i, std::int32_t j) noexcept {
    const bool diagonal = whole.row == whole.column;
    const std::int32_t index = diagonal ? i + j : 2 * i + j;
    return {static_cast<std::size_t>(c.blocks[whole.block].first_child + index), whole.level + 1,
            2 * whole.row + i, 2 * whole.column + j};
}

Eigen::Matrix3f block_of(const HierarchicalCompliance& c, std::int32_t a, std::int32_t b) noexcept {
    const std::int32_t p = c.positions[a], q = c.positions[b];
    const std::int32_t row = std::max(p, q), column = std::min(p, q);
    Place place{0, 0, 0, 0};
    while (c.blocks[place.block].first_child > 0)
        place = part(c, place, row >= c.begin(place.level + 1, 2 * place.row + 1) ? 1 : 0,
                     column >= c.begin(place.level + 1, 2 * place.column + 1) ? 1 : 0);

    const ComplianceBlock& block = c.blocks[place.block];
    const std::int32_t row_begin = c.begin(place.level, place.row),
                       row_end = c.begin(place.level, place.row + 1),
                       column_begin = c.begin(place.level, place.column),
                       column_end = c.begin(place.level, place.column + 1);
    const float* values = c.values.get() + block.values;
    Eigen::Matrix3f result;
    if (block.rank == ComplianceBlock::dense) {
        const Index width = 3 * Index{column_end - column_begin};
        result = rows_of(values, row - row_begin, width).middleCols<3>(3 * Index{column - column_begin});
    } else {
        const std::int64_t rank = block.rank;
        Factors u = c.factors.get() + block.factors + 3 * rank * (row - row_begin);
        Factors v =
            c.factors.get() + block.factors + 3 * rank * (row_end - row_begin + column - column_begin);
        std::array<float, HierarchicalCompliance::max_rank> weights;
        for (Index axis = 0; axis < 3; ++axis) {
            for (std::int64_t k = 0; k < rank; ++k)
                weights[k] = values[k] * static_cast<float>(v[axis * rank + k]);
            for (Index i = 0; i < 3; ++i) result(i, axis) = dot(u + i * rank, weights.data(), block.rank);
        }
    }
    if (p < q) result.transposeInPlace();
    return result;
}

// Forces by position, ascending.
using Loads = std::span<const NodeForce>;

Loads within(Loads loads, std::int32_t begin, std::int32_t end) noexcept {
    const auto first = std::ranges::lower_bound(loads, begin, {}, &NodeForce::node);
    const auto last = std::ranges::lower_bound(first, loads.end(), end, {}, &NodeForce::node);
    return {first, last};
}

class Product {
  public:
    Product(const HierarchicalCompliance& compliance, std::span<Eigen::Vector3f> displacements) noexcept
        : c_(compliance), u_(displacements) {}

    void add(const Place& place, Loads on_rows, Loads on_columns) noexcept {
        if (on_rows.empty() && on_columns.empty()) return;
        const bool diagonal = place.row == place.column;
        const ComplianceBlock& block = c_.blocks[place.block];
        if (block.first_child > 0) {
            const std::int32_t row_middle = c_.begin(place.level + 1, 2 * place.row + 1),
                               column_middle = c_.begin(place.level + 1, 2 * place.column + 1);
            const std::array rows{within(on_rows, 0, row_middle), within(on_rows, row_middle, c_.node_count)};
            const std::array columns{within(on_columns, 0, column_middle),
                                     within(on_columns, column_middle, c_.node_count)};
            for (std::int32_t i = 0; i < 2; ++i)
                for (std::int32_t j = 0; j < (diagonal ? i + 1 : 2); ++j)
                    add(part(c_, place, i, j), rows[i], columns[j]);
            return;
        }
        const std::int32_t row_begin = c_.begin(place.level, place.row),
                           row_end = c_.begin(place.level, place.row + 1),
                           column_begin = c_.begin(place.level, place.column),
                           column_end = c_.begin(place.level, place.column + 1);
        const float* values = c_.values.get() + block.values;
        if (block.rank == ComplianceBlock::dense) {
            const Index width = 3 * Index{column_end - column_begin};
            for (const NodeForce& load : on_columns)
                for (std::int32_t p = row_begin; p < row_end; ++p)
                    displaced(p) += rows_of(values, p - row_begin, width)
                                        .middleCols<3>(3 * Index{load.node - column_begin})
                                        .lazyProduct(load.force);
            if (diagonal) return;
            for (const NodeForce& load : on_rows)
                for (std::int32_t q = column_begin; q < column_end; ++q)
                    displaced(q) += rows_of(values, load.node - row_begin, width)
                                        .middleCols<3>(3 * Index{q - column_begin})
                                        .transpose()
                                        .lazyProduct(load.force);
            return;
        }
        Factors u = c_.factors.get() + block.factors;
        Factors v = u + 3 * std::int64_t{row_end - row_begin} * block.rank;
        add_low_rank(values, u, row_begin, row_end, v, column_begin, block.rank, on_columns);
        add_low_rank(values, v, column_begin, column_end, u, row_begin, block.rank, on_rows);
    }

  private:
    Eigen::Vector3f& displaced(std::int32_t position) noexcept { return u_[c_.order[position]]; }

    // Displacements += U diag(s) Vᵀ f for forces on the rows of V.
    void add_low_rank(const float* s, Factors u, std::int32_t u_begin, std::int32_t u_end, Factors v,
                      std::int32_t v_begin, std::int32_t rank, Loads loads) noexcept {
        if (loads.empty()) return;
        const auto width = static_cast<std::size_t>(rank);
        std::fill_n(weights_.begin(), width, 0.0F);
        for (const NodeForce& load : loads) {
            Factors rows = v + 3 * width * static_cast<std::size_t>(load.node - v_begin);
            for (std::size_t k = 0; k < width; ++k)
                weights_[k] += load.force[0] * static_cast<float>(rows[k]) +
                               load.force[1] * static_cast<float>(rows[width + k]) +
                               load.force[2] * static_cast<float>(rows[2 * width + k]);
        }
        for (std::size_t k = 0; k < width; ++k) weights_[k] *= s[k];
        for (std::int32_t p = u_begin; p < u_end; ++p) {
            Factors rows = u + 3 * width * static_cast<std::size_t>(p - u_begin);
            displaced(p) +=
                Eigen::Vector3f(dot(rows, weights_.data(), rank), dot(rows + width, weights_.data(), rank),
                                dot(rows + 2 * width, weights_.data(), rank));
        }
    }

    const HierarchicalCompliance& c_;
    std::span<Eigen::Vector3f> u_;
    std::array<float, HierarchicalCompliance::max_rank> weights_;
};

void add_products(const HierarchicalCompliance& c, std::span<const NodeForce> forces,
                  std::span<Eigen::Vector3f> displacements) noexcept {
    std::array<NodeForce, 256> loads;  // more forces take several rounds
    Product product(c, displacements);
    while (!forces.empty()) {
        const std::size_t count = std::min(forces.size(), loads.size());
        for (std::size_t i = 0; i < count; ++i) loads[i] = {c.positions[forces[i].node], forces[i].force};
        const Loads chunk = std::span(loads).first(count);
        std::ranges::sort(loads.begin(), loads.begin() + static_cast<std::ptrdiff_t>(count), {},
                          &NodeForce::node);
        product.add({0, 0, 0, 0}, chunk, chunk);
        forces = forces.subspan(count);
    }
}

}  // namespace

std::int32_t node_count(const SurfaceCompliance& compliance) {
    if (const auto* dense = std::get_if<DenseCompliance>(&compliance)) return dense->node_count;
    return std::get_if<HierarchicalCompliance>(&compliance)->node_count;
}

std::size_t value_bytes(const SurfaceCompliance& compliance) {
    if (const auto* dense = std::get_if<DenseCompliance>(&compliance))
        return dense->dof_count() * dense->dof_count() * sizeof(float);
    const auto& blocks = *std::get_if<HierarchicalCompliance>(&compliance);
    return blocks.value_count * sizeof(float) + blocks.factor_count * sizeof(std::int16_t);
}

double allowed_error(const SurfaceCompliance& compliance) {
    const auto* blocks = std::get_if<HierarchicalCompliance>(&compliance);
    return blocks ? blocks->accuracy : 1e-6;
}

Eigen::Matrix3f compliance_block(const SurfaceCompliance& compliance, std::int32_t a,
                                 std::int32_t b) noexcept {
    assert(a >= 0 && a < node_count(compliance) && b >= 0 && b < node_count(compliance));
    if (const auto* dense = std::get_if<DenseCompliance>(&compliance)) return block_of(*dense, a, b);
    return block_of(*std::get_if<HierarchicalCompliance>(&compliance), a, b);
}

void add_displacements(const SurfaceCompliance& compliance, std::span<const NodeForce> forces,
                       std::span<Eigen::Vector3f> displacements) noexcept {
    assert(std::ssize(displacements) == node_count(compliance));
    assert(std::ranges::all_of(
        forces, [&](const NodeForce& load) { return load.node >= 0 && load.node < node_count(compliance); }));
    if (const auto* dense = std::get_if<DenseCompliance>(&compliance))
        add_products(*dense, forces, displacements);
    else
        add_products(*std::get_if<HierarchicalCompliance>(&compliance), forces, displacements);
}

}  // namespace palpate
