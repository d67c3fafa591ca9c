// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condensation/compress.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <array>
#include <memory>
#include <mutex>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "tools/fem/condensation/cluster_order.hpp"
#include "tools/fem/condensation/low_rank.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"

namespace palpate::fem {
namespace {

using Eigen::Index;
using Eigen::MatrixXd;

constexpr std::int32_t largest_leaf = 32;  // nodes; halves and doubles of it took more bytes

// Of the mean: a node behind held ones answers to no force but its own, and has this scale.
constexpr double least_scale = 1e-4;

// Factors are stored in steps of their columns' largest entries.
constexpr double steps = 32767;
// A block while it is made: split, of low rank, or dense.
struct Part {
    std::vector<Part> parts;
    std::optional<LowRank> low_rank;
    MatrixXd dense;
    std::int64_t size = 0;  // bytes that it stores
};

std::int64_t bytes_of(const LowRank& block) {
    return 2 * block.size() + 4 * block.rank();
}

// The blocks of one column of clusters, from the diagonal downwards.
using Column = std::vector<Part>;

class Compressor {
  public:
    Compressor(std::span<const Eigen::Vector3d> points, const ComplianceRows& rows, double accuracy)
        : rows_(rows) {
        result_.node_count = static_cast<std::int32_t>(points.size());
        result_.accuracy = accuracy;
        result_.depth = cluster_depth(result_.node_count, largest_leaf);
        result_.order = cluster_order(points, result_.depth);
        result_.positions.resize(result_.order.size());
        for (std::size_t p = 0; p < result_.order.size(); ++p)
            result_.positions[result_.order[p]] = static_cast<std::int32_t>(p);
        estimate_scales();
    }

    std::int32_t depth() const { return result_.depth; }
    std::int32_t clusters(std::int32_t level) const { return 1 << level; }

    // The column of cluster j at the last level, from its rows of C.
    Column leaf_column(std::int32_t j) const {
        const std::int32_t level = result_.depth, first = result_.begin(level, j);
        const std::int32_t count = result_.begin(level, j + 1) - first;
        const MatrixXd rows =
            rows_(std::span(result_.order)
                      .subspan(static_cast<std::size_t>(first), static_cast<std::size_t>(count)));
        Column column;
        for (std::int32_t i = j; i < clusters(level); ++i) {
            const std::int32_t begin = result_.begin(level, i), end = result_.begin(level, i + 1);
            MatrixXd block(3 * (end - begin), 3 * count);
            for (std::int32_t p = begin; p < end; ++p)
                block.middleRows<3>(3 * Index{p - begin}) =
                    inverse_scales_[p] * rows.middleCols<3>(3 * Index{result_.order[p]}).transpose();
            for (std::int32_t p = first; p < first + count; ++p)
                block.middleCols<3>(3 * Index{p - first}) *= inverse_scales_[p];
            Part part;
            if (i == j)
                block = MatrixXd(block + block.transpose()) / 2;
            else
                part.low_rank = truncated(block, tolerance(level, i, j));
            if (!part.low_rank) part.dense = std::move(block);
            part.size = part.low_rank ? bytes_of(*part.low_rank) : 4 * part.dense.size();
            column.push_back(std::move(part));
        }
        return column;
    }

    // Block (i, j) of a level from the columns of j's halves.
    Part join(std::int32_t level, std::int32_t i, std::int32_t j, Column& left, Column& right) const {
        const auto in_left = [&](std::int32_t row) { return std::move(left[row - 2 * j]); };
        const auto in_right = [&](std::int32_t row) { return std::move(right[row - 2 * j - 1]); };
        Part whole;
        whole.parts.push_back(in_left(2 * i));
        if (i != j) whole.parts.push_back(in_right(2 * i));
        whole.parts.push_back(in_left(2 * i + 1));
        whole.parts.push_back(in_right(2 * i + 1));
        for (const Part& part : whole.parts) whole.size += part.size;
        if (i != j) replace_by_low_rank(whole, tolerance(level, i, j));
        return whole;
    }

    HierarchicalCompliance stored(const Part& root) && {
        result_.blocks.resize(1);
        store(root, 0, 0, 0, 0);
        result_.value_count = values_.size();
        result_.factor_count = factors_.size();
        const auto values = std::make_shared<std::vector<float>>(std::move(values_));
        const auto factors = std::make_shared<std::vector<std::int16_t>>(std::move(factors_));
        result_.values = {values, values->data()};
        result_.factors = {factors, factors->data()};
        return std::move(result_);
    }

  private:
    // How strongly each node answers to a force in each direction: S_p² = the mean of C_ipᵀ C_ip over a
    // sample of nodes i all over the surface. (The few large entries around a node itself are mostly missed,
    // which makes this a cautious estimate.) Blocks are made of S_i^-1 C_ij S_j^-1: an error of the same size
    // anywhere in such a block is, for a force in any direction, the same part of the displacement field it
    // causes. Without this, forces on a slender body along its axis, where it is stiff, drown in the error of
    // those across.
    void estimate_scales() {
        std::vector<std::int32_t> sample = result_.order;
        std::shuffle(sample.begin(), sample.end(), std::mt19937_64(1));
        sample.resize(std::min<std::size_t>(sample.size(), std::size_t{2} * largest_leaf));
        const MatrixXd rows = rows_(sample);
        std::vector<Eigen::Matrix3d> squared;
        double sum = 0;
        for (const std::int32_t node : result_.order) {
            const MatrixXd answers = rows.middleCols<3>(3 * Index{node});
            squared.emplace_back(answers.transpose() * answers / static_cast<double>(rows.rows()));
            sum += squared.back().trace() / 3;
        }
        const double floor = least_scale * least_scale * sum / result_.node_count;
        for (Eigen::Matrix3d& one : squared) {
            one.diagonal().array() += floor;
            const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(one);
            scales_.push_back(axes.operatorSqrt());
            inverse_scales_.push_back(axes.operatorInverseSqrt());
        }
        entry_error_ = result_.accuracy / std::sqrt(sum / result_.node_count * (result_.depth + 1));
    }

    // Error that one step, truncation, joining or rounding, may add to a block; it takes part in some depth +
    // 1 of them.
    LowRankTolerance tolerance(std::int32_t level, std::int32_t i, std::int32_t j) const {
        const auto dofs = [&](std::int32_t c) {
            return static_cast<double>(3 * (result_.begin(level, c + 1) - result_.begin(level, c)));
        };
        return {.row = entry_error_ * std::sqrt(dofs(j)), .column = entry_error_ * std::sqrt(dofs(i))};
    }

    static void replace_by_low_rank(Part& whole, const LowRankTolerance& tolerance) {
        std::array<LowRank, 4> dense;
        std::array<const LowRank*, 4> factors{};
        for (std::size_t k = 0; k < 4; ++k) {
            const Part& part = whole.parts[k];
            if (!part.parts.empty()) return;
            if (!part.low_rank)
                dense[k] = {part.dense, MatrixXd::Identity(part.dense.cols(), part.dense.cols())};
            factors[k] = part.low_rank ? &*part.low_rank : &dense[k];
        }
        LowRank low_rank = joined(factors, tolerance);
        if (bytes_of(low_rank) > whole.size || low_rank.rank() > HierarchicalCompliance::max_rank) return;
        whole.size = bytes_of(low_rank);
        whole.low_rank = std::move(low_rank);
        whole.parts.clear();
    }

    // Multiplies a factor's rows by what each of a cluster's nodes has.
    MatrixXd multiplied(const std::vector<Eigen::Matrix3d>& of_nodes, MatrixXd factor, std::int32_t level,
                        std::int32_t cluster) const {
        const std::int32_t first = result_.begin(level, cluster);
        for (Index node = 0; node < factor.rows() / 3; ++node)
            factor.middleRows<3>(3 * node) =
                MatrixXd(of_nodes[first + node] * factor.middleRows<3>(3 * node));
        return factor;
    }

    // Takes the scales of a cluster's nodes back from a factor's rows.
    MatrixXd unscaled(MatrixXd factor, std::int32_t level, std::int32_t cluster) const {
        return multiplied(scales_, std::move(factor), level, cluster);
    }

    void store(const Part& part, std::size_t index, std::int32_t level, std::int32_t i, std::int32_t j) {
        if (!part.parts.empty()) {
            const std::size_t first = result_.blocks.size();
            result_.blocks[index].first_child = static_cast<std::int32_t>(first);
            result_.blocks.resize(first + part.parts.size());
            std::size_t k = 0;
            for (std::int32_t di = 0; di < 2; ++di)
                for (std::int32_t dj = 0; dj < (i == j ? di + 1 : 2); ++dj, ++k)
                    store(part.parts[k], first + k, level + 1, 2 * i + di, 2 * j + dj);
            return;
        }
        ComplianceBlock& block = result_.blocks[index];
        block.values = static_cast<std::int64_t>(values_.size());
        if (!part.low_rank) {
            MatrixXd dense = unscaled(unscaled(part.dense, level, i).transpose(), level, j).transpose();
            if (i == j) dense = MatrixXd(dense + dense.transpose()) / 2;
            for (Index row = 0; row < dense.rows(); ++row)
                for (Index column = 0; column < dense.cols(); ++column)
                    values_.push_back(static_cast<float>(dense(row, column)));
            return;
        }
        const LowRank low_rank = fit_for_rounding(*part.low_rank, level, i, j);
        const Index rank = low_rank.rank(), padded = (rank + 3) / 4 * 4;
        block.rank = static_cast<std::int32_t>(padded);
        block.factors = static_cast<std::int64_t>(factors_.size());
        Eigen::VectorXd scales = Eigen::VectorXd::Zero(padded);
        scales.head(rank).setOnes();
        append_factor(low_rank.u, scales);
        append_factor(low_rank.v, scales);
        for (const double scale : scales) values_.push_back(static_cast<float>(scale));
    }

    // The block with its scales taken back, so that its factors may be rounded. Steps of a column's largest
    // entry are too coarse for its small ones where two soft nodes answer to each other, and to nothing else
    // as strongly, across two clusters. What rounding leaves of such columns is put beside them:
    // u vᵀ = [u] [v]ᵀ + (u - [u]) [v]ᵀ + [u] (v - [v])ᵀ, but for the product of both rests.
    LowRank fit_for_rounding(const LowRank& scaled, std::int32_t level, std::int32_t i,
                             std::int32_t j) const {
        const LowRankTolerance limit = tolerance(level, i, j);
        const LowRank whole{unscaled(scaled.u, level, i), unscaled(scaled.v, level, j)};
        const LowRank rounded{in_steps(whole.u), in_steps(whole.v)};
        const MatrixXd rest_u = whole.u - rounded.u, rest_v = whole.v - rounded.v;
        const auto coarse = [&](const MatrixXd& rest, std::int32_t cluster, const MatrixXd& other,
                                double most) {
            return columns_to_mend(
                multiplied(inverse_scales_, rest, level, cluster) * other.colwise().norm().asDiagonal(),
                most);
        };
        std::vector<Index> of_u = coarse(rest_u, i, scaled.v, limit.row),
                           of_v = coarse(rest_v, j, scaled.u, limit.column);
        const auto room = static_cast<std::size_t>(HierarchicalCompliance::max_rank - whole.rank());
        of_u.resize(std::min(of_u.size(), room));
        of_v.resize(std::min(of_v.size(), room - of_u.size()));
        LowRank fit{MatrixXd(whole.u.rows(), whole.rank() + std::ssize(of_u) + std::ssize(of_v)), {}};
        fit.v.resize(whole.v.rows(), fit.u.cols());
        fit.u << whole.u, rest_u(Eigen::all, of_u), rounded.u(Eigen::all, of_v);
        fit.v << whole.v, rounded.v(Eigen::all, of_u), rest_v(Eigen::all, of_v);
        return fit;
    }

    // The columns without which every row's Euclidean norm is within the limit, the worst row's largest
    // entries first.
    static std::vector<Index> columns_to_mend(MatrixXd errors, double limit) {
        std::vector<Index> columns;
        for (;;) {
            Index row = 0, column = 0;
            if (errors.size() == 0 || errors.rowwise().squaredNorm().maxCoeff(&row) <= limit * limit)
                return columns;
            errors.row(row).cwiseAbs().maxCoeff(&column);
            errors.col(column).setZero();
            columns.push_back(column);
        }
    }

    static Eigen::RowVectorXd largest_of(const MatrixXd& factor) {
        return factor.size() > 0 ? Eigen::RowVectorXd(factor.cwiseAbs().colwise().maxCoeff())
                                 : Eigen::RowVectorXd::Zero(factor.cols());
    }

    static MatrixXd in_steps(MatrixXd factor) {
        const Eigen::RowVectorXd largest = largest_of(factor);
        for (Index k = 0; k < factor.cols(); ++k)
            if (largest[k] > 0)
                factor.col(k) = (factor.col(k) / largest[k] * steps).array().round() * (largest[k] / steps);
        return factor;
    }

    // Rounds each column to 16 bits of its largest entry and multiplies its scale accordingly.
    void append_factor(const MatrixXd& factor, Eigen::VectorXd& scales) {
        const Eigen::RowVectorXd largest = largest_of(factor);
        for (Index row = 0; row < factor.rows(); ++row)
            for (Index k = 0; k < scales.size(); ++k)
                factors_.push_back(
                    k < factor.cols() && largest[k] > 0
                        ? static_cast<std::int16_t>(std::lround(factor(row, k) / largest[k] * steps))
                        : std::int16_t{0});
        for (Index k = 0; k < factor.cols(); ++k) scales[k] *= largest[k] / steps;
    }

    const ComplianceRows& rows_;
    HierarchicalCompliance result_;
    std::vector<float> values_;
    std::vector<std::int16_t> factors_;
    std::vector<Eigen::Matrix3d> scales_, inverse_scales_;  // by position, mm/N and its inverse
    double entry_error_ = 0;  // of scaled entries, root mean square, in one step
};

}  // namespace

HierarchicalCompliance compress(std::span<const Eigen::Vector3d> points, const ComplianceRows& rows,
                                double accuracy, int threads, const ProgressCallback& progress) {
    Compressor compressor(points, rows, accuracy);
    const std::int32_t depth = compressor.depth();
    const auto column_count = [&](std::int32_t level) {
        return static_cast<std::size_t>(compressor.clusters(level));
    };

    std::mutex telling;
    std::size_t panels_done = 0;
    const auto leaf = [&](std::size_t j) {
        Column column = compressor.leaf_column(static_cast<std::int32_t>(j));
        const std::lock_guard lock(telling);
        progress("compressing",
                 static_cast<double>(++panels_done) / static_cast<double>(column_count(depth)));
        return column;
    };
    // A subtree's columns are joined as soon as both halves are there, so that little waits in memory.
    const std::function<Column(std::int32_t, std::size_t)> column_of = [&](std::int32_t level,
                                                                           std::size_t j) {
        if (level == depth) return leaf(j);
        Column left = column_of(level + 1, 2 * j), right = column_of(level + 1, 2 * j + 1);
        Column column;
        for (std::size_t i = j; i < column_count(level); ++i)
            column.push_back(compressor.join(level, static_cast<std::int32_t>(i),
                                             static_cast<std::int32_t>(j), left, right));
        return column;
    };
    std::int32_t level = std::min(depth, 5);
    std::vector<Column> columns(column_count(level));
    for_each_index(columns.size(), threads, [&](std::size_t j) { columns[j] = column_of(level, j); });
    while (level-- > 0) {
        std::vector<Column> halves = std::exchange(columns, std::vector<Column>(column_count(level)));
        std::vector<std::pair<std::size_t, std::size_t>> blocks;
        for (std::size_t j = 0; j < columns.size(); ++j) {
            columns[j].resize(columns.size() - j);
            for (std::size_t i = j; i < columns.size(); ++i) blocks.emplace_back(i, j);
        }
        for_each_index(blocks.size(), threads, [&](std::size_t b) {
            const auto [i, j] = blocks[b];
            columns[j][i - j] =
                compressor.join(level, static_cast<std::int32_t>(i), static_cast<std::int32_t>(j),
                                halves[2 * j], halves[2 * j + 1]);
        });
    }
    return std::move(compressor).stored(columns[0][0]);
}

}  // namespace palpate::fem
