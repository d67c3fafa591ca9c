// SPDX-License-Identifier: GPL-3.0-or-later
// What bench_meshing.py needs beside the commands: one label cut out, plain CGAL on it, one judge for all
// meshes.
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Image_3.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/make_mesh_3.h>
#include <algorithm>
#include <array>
#include <cstdio>
#include <exception>
#include <fstream>
#include <string>
#include <vector>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/meshing/contract/fidelity.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/tetrahedra/tetrahedralise.hpp"

namespace palpate {
namespace {

using namespace imaging;
using namespace meshing;

// Cuts a label with a margin out of a map, at the origin and along the axes, which is all that Image_3 knows;
// writes it as FOLDER/case.seg.nrrd and FOLDER/case.inr.
void extract(const std::string& labels, const std::string& name, const std::string& folder) {
    const LabelMap map = read_label_map(labels);
    const Label label = require_label(map, name, labels);
    std::array<std::int32_t, 3> low = map.grid.size, high{-1, -1, -1};
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < map.grid.size[0]; ++i, ++offset) {
                if (map.labels[offset] != label.value) continue;
                const std::array<std::int32_t, 3> index{i, j, k};
                for (std::size_t axis = 0; axis < 3; ++axis) {
                    low[axis] = std::min(low[axis], index[axis]);
                    high[axis] = std::max(high[axis], index[axis]);
                }
            }
    constexpr std::int32_t margin = 4;
    LabelMap part;
    part.grid.spacing = map.grid.spacing;
    part.names = {{1, "body", label.colour}};
    for (std::size_t axis = 0; axis < 3; ++axis)
        part.grid.size[axis] = high[axis] - low[axis] + 1 + 2 * margin;
    std::string bytes;
    for (std::int32_t k = 0; k < part.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < part.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < part.grid.size[0]; ++i) {
                const std::int32_t x = i + low[0] - margin, y = j + low[1] - margin, z = k + low[2] - margin;
                const bool inside =
                    map.grid.contains(x, y, z) && map.labels[map.grid.offset(x, y, z)] == label.value;
                part.labels.push_back(inside);
                bytes += inside ? '\1' : '\0';
            }
    write_label_map(folder + "/case.seg.nrrd", part);
    const auto& [nx, ny, nz] = part.grid.size;
    const Eigen::Vector3d& v = part.grid.spacing;
    std::string header =
        "#INRIMAGE-4#{\nXDIM=" + std::to_string(nx) + "\nYDIM=" + std::to_string(ny) +
        "\nZDIM=" + std::to_string(nz) +
        "\nVDIM=1\nTYPE=unsigned fixed\nPIXSIZE=8 bits\nSCALE=2**0\nCPU=decm\nVX=" + std::to_string(v.x()) +
        "\nVY=" + std::to_string(v.y()) + "\nVZ=" + std::to_string(v.z()) + "\n";
    header.resize(252, '\n');
    std::ofstream(folder + "/case.inr", std::ios::binary) << header << "##}\n" << bytes;
}

// The user manual's example: nearest labels, default optimisation.
void plain_cgal(const std::string& image_path, double size, const std::string& output) {
    using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
    using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
    using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
    using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
    CGAL::Image_3 image;
    if (!image.read(image_path.c_str())) throw InvalidInput({image_path, "is no image", "", ""});
    const Domain domain = Domain::create_labeled_image_mesh_domain(image);
    namespace parameters = CGAL::parameters;
    const CGAL::Mesh_criteria_3<Triangulation> criteria(
        parameters::facet_angle = 30, parameters::facet_size = size, parameters::facet_distance = size / 10,
        parameters::cell_radius_edge_ratio = 3, parameters::cell_size = size);
    const auto mesh = CGAL::make_mesh_3<Complex>(domain, criteria);
    std::ofstream stream(output);
    mesh.output_to_medit(stream);
}

void write_stl(const std::string& surface_path, const std::string& output) {
    const TriangleMesh surface = read_surface(surface_path);
    std::ofstream stream(output);
    stream.precision(9);
    stream << "solid body\n";
    for (const Triangle& t : surface.triangles) {
        stream << "facet normal 0 0 0\nouter loop\n";
        for (const std::int32_t v : t)
            stream << "vertex " << surface.vertices[static_cast<std::size_t>(v)].transpose() << "\n";
        stream << "endloop\nendfacet\n";
    }
    stream << "endsolid body\n";
}

// All that the table needs of a mesh, as one line of JSON.
void judge(const std::string& mesh_path, const std::string& labels_path) {
    TetMesh mesh = read_imported_tetrahedra(mesh_path, {});
    std::ranges::fill(mesh.regions, 1);
    mesh.region_names = {{1, "body", {}}};
    const LabelMap map = read_label_map(labels_path);
    const MeshQuality quality = measure(mesh);
    const std::array<std::int32_t, 1> body{1};
    const auto [labels, smoothed] = prepare_domain(map, body, -1, 40);
    const RegionFidelity fidelity = compare(mesh, labels).body;
    const RegionDistance distance = region_distances(mesh, labels, region_surfaces(labels, smoothed)).front();
    const TriangleMesh boundary = boundary_surface(mesh).surface;
    std::printf(
        R"({"tetrahedra": %zu, "triangles": %zu, "min_deg": %g, "max_deg": %g, "volume_percent": %g, "dice": %g, )"
        R"("mean": %g, "p95": %g, "max": %g})"
        "\n",
        mesh.tetrahedra.size(), boundary.triangles.size(), quality.min_dihedral_deg, quality.max_dihedral_deg,
        fidelity.volume_error_percent, fidelity.dice, distance.mean, distance.percentile_95,
        distance.maximum);
}

int run(int count, char** words) {
    const std::vector<std::string> w(words, words + count);
    const std::string job = count > 1 ? w[1] : "";
    if (job == "extract" && count == 5)
        extract(w[2], w[3], w[4]);
    else if (job == "cgal" && count == 5)
        plain_cgal(w[2], std::stod(w[3]), w[4]);
    else if (job == "stl" && count == 4)
        write_stl(w[2], w[3]);
    else if (job == "judge" && count == 4)
        judge(w[2], w[3]);
    else
        return std::fputs(
                   "usage: meshing_peer extract LABELS NAME FOLDER | cgal IMAGE.inr SIZE OUT.mesh | stl "
                   "SURFACE.vtp OUT.stl | judge MESH LABELS\n",
                   stderr),
               2;
    return 0;
}

}  // namespace
}  // namespace palpate

int main(int count, char** words) {
    try {
        return palpate::run(count, words);
    } catch (const std::exception& error) {
        std::fprintf(stderr, "meshing_peer: %s\n", error.what());
        return 1;
    }
}
