// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/quality.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "tools/meshing/measures/quality.hpp"

namespace palpate::report {
namespace {

void count(BinCounts& histogram, double value) {
    const double bins = static_cast<double>(histogram.counts.size());
    const double bin = std::floor((value - histogram.low) / (histogram.high - histogram.low) * bins);
    ++histogram.counts[static_cast<std::size_t>(std::clamp(bin, 0.0, bins - 1))];
}

}  // namespace

MeshSummary summarise(const TetMesh& mesh) {
    MeshSummary summary;
    summary.dihedral_deg = {0, 180, std::vector<std::int64_t>(36)};
    summary.radius_ratio = {0, 1, std::vector<std::int64_t>(20)};
    summary.region_volumes.resize(mesh.region_names.size());
    summary.min_volume = std::numeric_limits<double>::infinity();
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const meshing::TetShape shape = meshing::tet_shape(mesh, t);
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

}  // namespace palpate::report
