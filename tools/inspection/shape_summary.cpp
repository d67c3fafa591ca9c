// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/inspection/shape_summary.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>

#include "formats/asset/hdf5/digest.hpp"
#include "formats/model/errors.hpp"
#include "tools/draft/case_draft.hpp"
#include "tools/inspection/text.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/imported_placement.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/surfaces/joined_vertices.hpp"
#include "tools/stages/mesh_result.hpp"

namespace palpate::inspection {
namespace {

using namespace meshing;
using Json = nlohmann::ordered_json;

Eigen::AlignedBox3d box_around(const std::vector<Eigen::Vector3d>& points) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : points) box.extend(p);
    return box;
}

Json box_json(const Eigen::AlignedBox3d& box) {
    return {{"min_mm", {box.min().x(), box.min().y(), box.min().z()}},
            {"max_mm", {box.max().x(), box.max().y(), box.max().z()}}};
}

std::string box_text(const Eigen::AlignedBox3d& box) {
    return place(box.min()) + " to " + place(box.max()) + ", " + lengths(box.sizes()) + " mm, LPS";
}

Json edges_json(const EdgeLengths& edges) {
    return {{"shortest", edges.shortest}, {"mean", edges.mean}, {"longest", edges.longest}};
}

std::string edges_text(const EdgeLengths& edges) {
    return fmt::format("{:.3g} to {:.3g} mm, {:.3g} on average", edges.shortest, edges.longest, edges.mean);
}

Json closed_json(const SurfaceQuality& quality) {
    return {{"closed", quality.open_edges == 0},
            {"manifold", quality.non_manifold_edges == 0},
            {"open_edges", quality.open_edges},
            {"non_manifold_edges", quality.non_manifold_edges},
            {"misoriented_edges", quality.misoriented_edges},
            {"degenerate_triangles", quality.degenerate_triangles}};
}

std::string closed_text(const SurfaceQuality& quality) {
    if (quality.closed_and_oriented()) return "closed, manifold, facing outwards";
    return fmt::format(
        "not the boundary of a body: {} open, {} non-manifold and {} misoriented edges, {} triangles without "
        "area{}",
        quality.open_edges, quality.non_manifold_edges, quality.misoriented_edges,
        quality.degenerate_triangles, quality.volume > 0 ? "" : ", facing inwards");
}

// The reader's notes, and what it cannot know of the unit.
std::string add_doubts(std::vector<std::string> notes, double extent, Json& json) {
    if (const std::string unit = draft::plausible_unit(extent); unit != "mm")
        notes.push_back(fmt::format(
            "{:.3g} mm across is little for an organ: is the file in {}? ('--unit {}' of mesh and surface)",
            extent, unit, unit));
    json["notes"] = notes;
    std::string text;
    for (const std::string& note : notes) text += "note: " + note + "\n";
    return text;
}

}  // namespace

Summary summary_of_tetrahedra(const std::filesystem::path& path) {
    std::vector<std::string> notes;
    const UnrepairedTetrahedra read =
        read_unrepaired_tetrahedra(path, {}, [&](std::string_view said) { notes.emplace_back(said); });
    const TetMesh& mesh = read.mesh;
    const MeshQuality quality = measure(mesh);
    const TriangleMesh boundary = boundary_surface(mesh).surface;
    const EdgeLengths edges = edge_lengths(mesh);
    const Eigen::AlignedBox3d box = box_around(mesh.rest_positions);
    const std::string digest = asset::surface_digest(boundary);

    Json cells = {{"tetrahedron", mesh.tetrahedra.size()}};
    cells.update(Json(read.other_cells));
    std::string cell_text;
    for (const auto& [kind, count] : cells.items())
        cell_text += fmt::format("{}{} {}", cell_text.empty() ? "" : ", ", count.get<std::int64_t>(), kind);
    Json regions = Json::array();
    std::vector<std::vector<std::string>> rows{{"region", "value", "tetrahedra", "ml"}};
    for (const RegionVolume& region : quality.region_volumes) {
        const auto label = std::ranges::find(mesh.region_names, region.region, &Label::value);
        const auto count = std::ranges::count(mesh.regions, region.region);
        regions.push_back({{"name", label->name},
                           {"value", region.region},
                           {"tetrahedra", count},
                           {"volume_ml", region.volume / 1000}});
        rows.push_back({label->name, std::to_string(region.region), std::to_string(count),
                        fmt::format("{:.3f}", region.volume / 1000)});
    }
    Json json = stages::to_json(mesh, quality);
    json["cells"] = cells;
    json["regions"] = regions;
    json["boundary_triangles"] = boundary.triangles.size();
    json["boundary"] = closed_json(quality.boundary);
    json["edges_mm"] = edges_json(edges);
    json["box"] = box_json(box);
    json["surface_sha256"] = digest;
    const std::string text =
        aligned(
            {{"mesh", fmt::format("{} points, cells: {}", mesh.rest_positions.size(), cell_text)},
             {"box", box_text(box)},
             {"edges", edges_text(edges)},
             {"dihedral angles",
              fmt::format("{:.1f} to {:.1f} degrees; 1 % below {:.1f}, 1 % above {:.1f}",
                          quality.min_dihedral_deg, quality.max_dihedral_deg,
                          quality.dihedral_percentiles_deg.front(), quality.dihedral_percentiles_deg.back())},
             {"inverted", std::to_string(quality.inverted)},
             {"pieces", std::to_string(quality.components)},
             {"boundary",
              fmt::format("{} triangles, {}", boundary.triangles.size(), closed_text(quality.boundary))},
             {"surface digest", digest.substr(0, 16) + "..."}}) +
        "\n" + table(rows);
    const std::string doubts = add_doubts(std::move(notes), box.sizes().maxCoeff(), json);
    return {.form = "mesh", .json = std::move(json), .text = text + doubts};
}

Summary summary_of_surface(const std::filesystem::path& path) {
    std::vector<std::string> notes;
    TriangleMesh surface =
        read_unrepaired_surface(path, {}, [&](std::string_view said) { notes.emplace_back(said); });
    // Palpate's own is taken as it is, with its digest; other formats know no points that triangles share.
    if (extension_of(path) != ".vtp") surface = joined_vertices(surface);
    if (surface.triangles.empty())
        throw InvalidInput({path.string(), "holds no triangles", "", "check how it was made"});
    const SurfaceQuality quality = measure(surface);
    const EdgeLengths edges = edge_lengths(surface);
    const Eigen::AlignedBox3d box = box_around(surface.vertices);
    const std::string digest = asset::surface_digest(surface);
    Json json = {{"vertices", surface.vertices.size()},
                 {"triangles", surface.triangles.size()},
                 {"pieces", quality.components},
                 {"area_mm2", quality.area},
                 {"volume_mm3", quality.volume},
                 {"boundary", closed_json(quality)},
                 {"edges_mm", edges_json(edges)},
                 {"box", box_json(box)},
                 {"surface_sha256", digest}};
    const std::string text =
        aligned({{"surface",
                  fmt::format("{} points, {} triangles", surface.vertices.size(), surface.triangles.size())},
                 {"box", box_text(box)},
                 {"edges", edges_text(edges)},
                 {"area, volume",
                  fmt::format("{:.1f} cm², {}", quality.area / 100,
                              quality.open_edges == 0 ? fmt::format("{:.3f} ml", quality.volume / 1000)
                                                      : "encloses none: it is open")},
                 {"pieces", std::to_string(quality.components)},
                 {"boundary", closed_text(quality)},
                 {"surface digest", digest.substr(0, 16) + "..."}});
    const std::string doubts = add_doubts(std::move(notes), box.sizes().maxCoeff(), json);
    return {.form = "surface", .json = std::move(json), .text = text + doubts};
}

}  // namespace palpate::inspection
