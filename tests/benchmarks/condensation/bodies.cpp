// SPDX-License-Identifier: GPL-3.0-or-later
// Makes the bodies of the condensation benchmark, FOLDER/uniform_1200.vtu ...: an ellipsoid of a liver's
// size in tetrahedra of one size, or graded towards the inside. Those that are there stay.
// usage: condensation_bodies FOLDER [KIND_NODES ...]
#include <cmath>
#include <cstdio>
#include <exception>
#include <filesystem>
#include <string>
#include <vector>

#include "formats/model/errors.hpp"
#include "tools/experiments/ellipsoid.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/meshing/tetrahedra/tetrahedralise.hpp"

namespace palpate {
namespace {

using namespace experiments;
using namespace meshing;

constexpr std::int32_t organ = 1;

LabelMap ellipsoid_labels(double voxel_edge) {
    constexpr int margin = 4;
    LabelMap map;
    map.grid.spacing.setConstant(voxel_edge);
    for (Eigen::Index axis = 0; axis < 3; ++axis)
        map.grid.size[static_cast<std::size_t>(axis)] =
            2 * (static_cast<std::int32_t>(std::ceil(ellipsoid_semi_axes[axis] / voxel_edge)) + margin) + 1;
    for (Eigen::Index axis = 0; axis < 3; ++axis)
        map.grid.origin[axis] = -0.5 * voxel_edge * (map.grid.size[static_cast<std::size_t>(axis)] - 1);
    map.names = {{organ, "ellipsoid", default_label_colour(organ)}};
    map.labels.reserve(map.grid.voxel_count());
    for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < map.grid.size[0]; ++i) {
                const Eigen::Vector3d p = map.grid.point_of(Eigen::Vector3d(i, j, k));
                map.labels.push_back(p.cwiseQuotient(ellipsoid_semi_axes).squaredNorm() <= 1 ? organ : 0);
            }
    return map;
}

// Sizes that give about `nodes` contact nodes; the factors were found by trial.
MeshSizing sizing_for(const std::string& kind, double nodes) {
    constexpr double area = 6.6e4;  // of the ellipsoid, mm²
    const double spacing = std::sqrt(area / nodes);
    MeshSizing sizing;
    sizing.facet_distance = spacing;  // the size decides, not the curvature
    if (kind == "uniform") {
        sizing.facet_size = 0.92 * spacing;
        sizing.cell_size = 0.87 * spacing;
    } else if (kind == "graded") {
        sizing.facet_size = 0.78 * spacing;
        sizing.cell_size = 3 * spacing;
    } else if (kind == "gentle") {
        sizing.facet_size = 0.78 * spacing;
        sizing.cell_size = 1.4 * spacing;
    } else {
        throw UsageError({kind, "unknown kind of body", "uniform, graded or gentle", ""});
    }
    return sizing;
}

void make(const std::filesystem::path& folder, const std::string& name) {
    const std::filesystem::path path = folder / (name + ".vtu");
    if (std::filesystem::exists(path)) return;
    const auto underscore = name.find('_');
    if (underscore == std::string::npos) throw UsageError({name, "cannot be read", "uniform_1200", ""});
    const double nodes = std::stod(name.substr(underscore + 1));
    const MeshSizing sizing = sizing_for(name.substr(0, underscore), nodes);
    const LabelMap labels = ellipsoid_labels(std::min(2.0, sizing.facet_size));
    const std::vector<std::int32_t> values{organ};
    const TetMesh mesh = tetrahedralise(labels, values, sizing);
    write_tetrahedra(path, mesh);
    const DeformableBody body = held_body(mesh, ellipsoid_support);
    std::printf("%s: %zu tetrahedra, %zu nodes, %zu contact nodes, %zu held nodes\n", path.c_str(),
                mesh.tetrahedra.size(), mesh.rest_positions.size(), body.contact_nodes.size(),
                body.fixed_nodes.size());
    std::fflush(stdout);
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) try {
    if (argc < 2) {
        std::fprintf(stderr, "usage: condensation_bodies FOLDER [uniform_NODES | graded_NODES ...]\n");
        return 2;
    }
    std::vector<std::string> names(argv + 2, argv + argc);
    if (names.empty())
        names = {"uniform_1200", "uniform_2000", "uniform_2300", "uniform_3000",
                 "uniform_4100", "uniform_5000", "graded_300",   "graded_600",
                 "graded_1200",  "graded_2000",  "graded_2300",  "graded_3000",
                 "graded_4100",  "graded_5000",  "graded_10000", "graded_20000"};
    std::filesystem::create_directories(argv[1]);
    for (const std::string& name : names) palpate::make(argv[1], name);
    return 0;
} catch (const std::exception& error) {
    std::fprintf(stderr, "condensation_bodies: %s\n", error.what());
    return 1;
}
