// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/bodies/display_copy.hpp"

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <unordered_map>

#include "formats/model/errors.hpp"

namespace palpate::visual {
namespace {

// The cell of a vertex at a distance from the focus: edges are powers of two (mm), so that cells nest and far
// ones are few. One of the largest holds every vertex.
std::uint64_t cell_of(const Eigen::Vector3d& p, double distance, double coarseness) {
    constexpr int finest = -12, largest = 15;
    constexpr double first_corner = -16384;  // mm, of all levels: no coordinate is that far out
    const int level = std::clamp(std::ilogb(coarseness * distance), finest, largest);
    const double cells_per_mm = std::ldexp(1.0, -level);
    std::uint64_t key = static_cast<std::uint64_t>(level - finest);
    for (int axis = 0; axis < 3; ++axis) {
        const auto cell = static_cast<std::uint64_t>(cells_per_mm * (p[axis] - first_corner));
        key = key << 19 | (cell & 0x7FFFF);
    }
    return key;
}

// From the line, no less than `near`.
double distance_to(const std::vector<Eigen::Vector3d>& line, const Eigen::Vector3d& p, double near) {
    double nearest = (p - line.front()).squaredNorm();
    for (std::size_t i = 1; i < line.size(); ++i) {
        const Eigen::Vector3d way = line[i] - line[i - 1];
        const double share = std::clamp((p - line[i - 1]).dot(way) / way.squaredNorm(), 0.0, 1.0);
        nearest = std::min(nearest, (p - line[i - 1] - share * way).squaredNorm());
    }
    return std::max(near, std::sqrt(nearest));
}

// About how many cells hold a vertex: of as many bits as keys may hash to, those that stay unset tell (linear
// counting; Whang, Vander-Zanden, Taylor 1990), which takes less time than merging.
double cells_about(const std::vector<Eigen::Vector3d>& vertices, const std::vector<double>& distances,
                   double coarseness) {
    constexpr int log_bits = 22;
    constexpr double bits = 1 << log_bits;
    std::vector<bool> hit(1 << log_bits, false);
    std::size_t hits = 0;
    for (std::size_t i = 0; i < vertices.size(); ++i) {
        // Multiplicative hashing: the upper bits of a product with 2^64 by the golden ratio.
        const std::uint64_t hash =
            cell_of(vertices[i], distances[i], coarseness) * 0x9E3779B97F4A7C15 >> (64 - log_bits);
        hits += hit[hash] ? 0 : 1;
        hit[hash] = true;
    }
    return -bits * std::log1p(-std::min(static_cast<double>(hits), bits - 1) / bits);
}

// Merges the vertices of each cell into their mean; triangles that lose a corner vanish. `distances`: of the
// vertices.
TriangleMesh clustered(const TriangleMesh& surface, const std::vector<double>& distances, double coarseness) {
    std::unordered_map<std::uint64_t, std::int32_t> cluster_of_cell;
    cluster_of_cell.reserve(surface.vertices.size());
    std::vector<std::int32_t> cluster(surface.vertices.size()), members;
    TriangleMesh result;
    for (std::size_t i = 0; i < surface.vertices.size(); ++i) {
        const Eigen::Vector3d& p = surface.vertices[i];
        const auto [entry, added] = cluster_of_cell.try_emplace(cell_of(p, distances[i], coarseness),
                                                                static_cast<std::int32_t>(members.size()));
        cluster[i] = entry->second;
        if (added) {
            members.push_back(0);
            result.vertices.emplace_back(Eigen::Vector3d::Zero());
        }
        ++members[cluster[i]];
        result.vertices[cluster[i]] += p;
    }
    for (std::size_t c = 0; c < members.size(); ++c) result.vertices[c] /= members[c];
    for (const Triangle& t : surface.triangles) {
        const auto corner = [&](std::size_t i) { return cluster[t[i]]; };
        if (corner(0) != corner(1) && corner(1) != corner(2) && corner(2) != corner(0))
            result.triangles.push_back({corner(0), corner(1), corner(2)});
    }
    return result;
}

}  // namespace

TriangleMesh display_copy(const TriangleMesh& surface, std::int64_t budget,
                          const std::vector<Eigen::Vector3d>& focus, double near) {
    if (budget < 1)
        throw InvalidInput({"display copy", std::to_string(budget) + " triangles", "1 or more", ""});
    const auto fits = [&](const TriangleMesh& mesh) {
        return static_cast<std::int64_t>(mesh.triangles.size()) <= budget;
    };
    if (fits(surface)) return surface;
    std::vector<double> distances;
    for (const Eigen::Vector3d& p : surface.vertices) distances.push_back(distance_to(focus, p, near));
    // Of a smooth surface triangles are fewer by the square of the cells' size; steps finer than the least
    // would not be seen, for cells come in powers of two.
    constexpr double least_step = 1.4;
    const auto step = [&](double triangles) {
        return std::max(least_step, std::sqrt(triangles / static_cast<double>(budget)));
    };
    double coarseness = 1.0 / 64;
    // By Euler's formula, of one closed surface without handles.
    const auto triangles_about = [&] { return 2 * cells_about(surface.vertices, distances, coarseness) - 4; };
    for (double triangles = 0; (triangles = triangles_about()) > static_cast<double>(budget);)
        coarseness *= step(triangles);
    TriangleMesh copy;
    while (!fits(copy = clustered(surface, distances, coarseness)))
        coarseness *= step(static_cast<double>(copy.triangles.size()));
    return copy;
}

}  // namespace palpate::visual
