// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/quality.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <numbers>

namespace palpate {
namespace {

void count(BinCounts& histogram, double value) {
    const double bins = static_cast<double>(histogram.counts.size());
    const double bin = std::floor((value - histogram.low) / (histogram.high - histogram.low) * bins);
    ++histogram.counts[static_cast<std::size_t>(std::clamp(bin, 0.0, bins - 1))];
}

}  // namespace

TetShape tet_shape(const TetMesh& mesh, std::size_t t) {
    std::array<Eigen::Vector3d, 4> p;
    for (std::size_t corner = 0; corner < 4; ++corner)
        p[corner] = mesh.rest_positions[mesh.tetrahedra[t][corner]];
    const Eigen::Vector3d a = p[1] - p[0], b = p[2] - p[0], c = p[3] - p[0];
    // Outward normals, twice the area long, of the faces opposite to corners 0 ... 3.
    const std::array<Eigen::Vector3d, 4> normal{(p[2] - p[1]).cross(p[3] - p[1]), c.cross(b), a.cross(c),
                                                b.cross(a)};
    TetShape shape;
    std::size_t edge = 0;
    for (std::size_t i = 0; i < 4; ++i)
        for (std::size_t j = i + 1; j < 4; ++j) {
            const double outer = std::atan2(normal[i].cross(normal[j]).norm(), normal[i].dot(normal[j]));
            shape.dihedral_deg[edge++] = 180 - outer * 180 / std::numbers::pi;
        }
    const double six_v = a.dot(b.cross(c));
    assert(six_v > 0);
    double double_area = 0;
    for (const Eigen::Vector3d& n : normal) double_area += n.norm();
    const double inradius = six_v / double_area;
    const double circumradius =
        (a.squaredNorm() * b.cross(c) + b.squaredNorm() * c.cross(a) + c.squaredNorm() * a.cross(b)).norm() /
        (2 * six_v);
    shape.radius_ratio = 3 * inradius / circumradius;
    return shape;
}

MeshSummary summarise(const TetMesh& mesh) {
    MeshSummary summary;
    summary.dihedral_deg = {0, 180, std::vector<std::int64_t>(36)};
    summary.radius_ratio = {0, 1, std::vector<std::int64_t>(20)};
    summary.region_volumes.resize(mesh.region_names.size());
    summary.min_volume = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const TetShape shape = tet_shape(mesh, t);
        for (const double angle : shape.dihedral_deg) {
            count(summary.dihedral_deg, angle);
            summary.min_dihedral_deg = std::min(summary.min_dihedral_deg, angle);
            summary.max_dihedral_deg = std::max(summary.max_dihedral_deg, angle);
        }
        count(summary.radius_ratio, shape.radius_ratio);
        summary.min_radius_ratio = std::min(summary.min_radius_ratio, shape.radius_ratio);
        summary.mean_radius_ratio += shape.radius_ratio / static_cast<double>(mesh.tetrahedra.size());
        const double volume = six_volume(mesh, t) / 6;
        summary.min_volume = std::min(summary.min_volume, volume);
        const auto name = std::ranges::find(mesh.region_names, mesh.regions[t], &Label::value);
        if (name != mesh.region_names.end())
            summary.region_volumes[name - mesh.region_names.begin()] += volume;
    }
    return summary;
}

}  // namespace palpate
