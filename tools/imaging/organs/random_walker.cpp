// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/organs/random_walker.hpp"

#include <Eigen/Sparse>
#include <array>
#include <cmath>
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/voxels/coarse_grid.hpp"

namespace palpate::imaging {
namespace {

constexpr double least_weight = 1e-4;  // of a step over the steepest edge, so that the system stays regular
constexpr double accuracy = 1e-4;      // of the chances, relative: the border lies at one half

}  // namespace

Mask random_walk(const Volume& grey, const Walk& walk) {
    constexpr std::int32_t certain = -1;
    if (!(walk.noise > 0) || !(walk.trust_mm > 0) || walk.prior.size() != grey.values.size())
        throw InvalidInput({"the random walk to an organ's border",
                            fmt::format("noise {}, trust_mm {}, {} priors for {} voxels", walk.noise,
                                        walk.trust_mm, walk.prior.size(), grey.values.size()),
                            "noise and trust_mm above 0, one prior per voxel", ""});
    const ImageGrid& grid = grey.grid;
    Mask result = walk.inside;
    std::vector<std::int32_t> unknown(grid.voxel_count(), certain);
    std::int32_t count = 0;
    for (std::size_t i = 0; i < unknown.size(); ++i)
        if (!walk.inside.voxels[i] && !walk.outside.voxels[i]) unknown[i] = count++;
    if (count == 0) return result;

    const double trust = 1 / (walk.trust_mm * walk.trust_mm);
    std::vector<Eigen::Triplet<double>> entries;
    Eigen::VectorXd ends(count), start(count);
    const auto add = [&](std::size_t from, std::size_t to, double weight) {
        const std::int32_t row = unknown[from];
        if (row == certain) return;
        entries.emplace_back(row, row, weight);
        if (unknown[to] != certain)
            entries.emplace_back(row, unknown[to], -weight);
        else
            ends[row] += weight * walk.inside.voxels[to];
    };
    for (std::size_t i = 0; i < unknown.size(); ++i) {
        if (unknown[i] == certain) continue;
        start[unknown[i]] = double{walk.prior[i]};
        ends[unknown[i]] = trust * double{walk.prior[i]};
        entries.emplace_back(unknown[i], unknown[i], trust);
    }
    for_each_voxel(grid, [&](std::int32_t i, std::int32_t j, std::int32_t k, std::size_t here) {
        for (std::size_t axis = 0; axis < 3; ++axis) {
            std::array<std::int32_t, 3> at{i, j, k};
            if (++at[axis] == grid.size[axis]) continue;
            const std::size_t next = grid.offset(at[0], at[1], at[2]);
            if (unknown[here] == certain && unknown[next] == certain) continue;
            const double difference = (double{grey.values[here]} - double{grey.values[next]}) / walk.noise,
                         weight = (std::exp(-difference * difference / 4) + least_weight) /
                                  std::pow(grid.spacing[static_cast<Eigen::Index>(axis)], 2);
            add(here, next, weight);
            add(next, here, weight);
        }
    });
    Eigen::SparseMatrix<double> steps(count, count);
    steps.setFromTriplets(entries.begin(), entries.end());
    Eigen::ConjugateGradient<Eigen::SparseMatrix<double>, Eigen::Lower | Eigen::Upper> solver;
    solver.setTolerance(accuracy);
    const Eigen::VectorXd chances = solver.compute(steps).solveWithGuess(ends, start);
    if (solver.info() != Eigen::Success)
        throw SystemFailure({"the random walk to an organ's border",
                             fmt::format("did not converge: residual {:.1e} after {} steps", solver.error(),
                                         solver.iterations()),
                             fmt::format("{:.0e}", accuracy), "report this scan and its seeds"});
    for (std::size_t i = 0; i < unknown.size(); ++i)
        if (unknown[i] != certain) result.voxels[i] = chances[unknown[i]] >= 0.5;
    return result;
}

}  // namespace palpate::imaging
