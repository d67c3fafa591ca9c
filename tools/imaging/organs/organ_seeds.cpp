// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/organs/organ_seeds.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/imaging/voxels/seed_statistics.hpp"

namespace palpate::imaging {

OrganSeeds look_at_seeds(const Volume& volume, std::span<const Eigen::Vector3d> points,
                         const OrganParameters& p, const std::string& culprit,
                         const std::function<void(std::string_view)>& note) {
    OrganSeeds seeds{points, {}, 0};
    for (const Eigen::Vector3d& point : points) {
        std::vector<float> near = values_near(volume, std::span(&point, 1), seed_radius_mm);
        seeds.means.push_back(robust_statistics(near).mean);
        const double mean = seeds.means.back();
        if (mean < p.darkest_hu || mean > p.brightest_hu)
            throw InvalidInput({culprit,
                                fmt::format("seed {} lies in {} ({:.0f} HU)", point_text(point),
                                            mean > p.brightest_hu ? "bone or a strongly enhanced vessel"
                                            : mean < -300         ? "air"
                                                                  : "fat",
                                            mean),
                                fmt::format("{} to {} HU", p.darkest_hu, p.brightest_hu),
                                "move it into the organ (LPS mm; 3D Slicer shows RAS, x and y negated)"});
    }
    std::vector<double> sorted = seeds.means;
    std::ranges::sort(sorted);
    seeds.center = sorted[sorted.size() / 2];
    // One seed that differs from every other is suspected; streaks and fat make several differ.
    const std::vector<double> means = seeds.means;
    for (std::size_t n = 0; n < points.size(); ++n) {
        const auto alike = std::ranges::count_if(
            means, [&](double other) { return std::abs(other - means[n]) <= p.drift_hu; });
        if (alike > 1 || points.size() < 3) continue;
        if (note)
            note(
                fmt::format("{}: around seed {} it is {:.0f}{}, around the others {:.0f}{}; is it in a "
                            "vessel or another organ?",
                            culprit, point_text(points[n]), seeds.means[n] * p.per_hu, p.unit,
                            seeds.center * p.per_hu, p.unit));
        seeds.means[n] = std::nan("");
    }
    return seeds;
}

double expected_at(const OrganSeeds& seeds, const Eigen::Vector3d& p_P) {
    double sum = 0, weights = 0;
    for (std::size_t n = 0; n < seeds.means.size(); ++n) {
        if (std::isnan(seeds.means[n])) continue;
        const double weight = 1 / ((p_P - seeds.points[n]).squaredNorm() + 100);
        sum += weight * seeds.means[n];
        weights += weight;
    }
    return sum / weights;
}

}  // namespace palpate::imaging
