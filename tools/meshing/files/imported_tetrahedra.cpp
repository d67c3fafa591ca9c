// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/meshing/files/found_mesh.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/imported_placement.hpp"
#include "tools/meshing/labels/outside_labels.hpp"
#include "tools/meshing/measures/tet_faces.hpp"
#include "tools/meshing/surfaces/overlaps.hpp"
#include "tools/meshing/tetrahedra/body_repair.hpp"

namespace palpate::meshing {
namespace {

FoundTetrahedra read_solids(const std::filesystem::path& path) {
    const std::string extension = extension_of(path);
    if (extension == ".msh") return read_gmsh(path);
    if (extension == ".mesh") return read_medit(path);
    if (extension == ".vtu" || extension == ".vtk") return read_vtk_grid(path);
    throw InvalidInput({path.string(), "has the extension '" + extension + "'",
                        ".vtu, .vtk, .msh (Gmsh) or .mesh (MEDIT)",
                        "convert it, for example with meshio or Gmsh"});
}

void require_tetrahedra(const FoundTetrahedra& found, const std::string& culprit) {
    if (found.tetrahedra.empty())
        throw InvalidInput(
            {culprit, "holds no tetrahedra" + (found.flat.empty() ? "" : ", but " + listed(found.flat)), "",
             found.flat.contains("triangle") ? "a surface goes to 'palpate surface --surface-file'"
                                             : "check how it was made"});
}

void mark_surface(TetMesh& mesh) {
    mesh.outside_labels.assign(mesh.rest_positions.size(), -1);
    for (const std::int32_t node : boundary_surface(mesh).nodes) mesh.outside_labels[node] = 0;
}

std::string place_of(const TetMesh& mesh, std::size_t t) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::int32_t node : mesh.tetrahedra[t]) sum += mesh.rest_positions[node];
    return fmt::format("({:.2f}, {:.2f}, {:.2f})", sum.x() / 4, sum.y() / 4, sum.z() / 4);
}

std::int64_t drop_repeated_tetrahedra(FoundTetrahedra& found) {
    std::vector<std::pair<Tetrahedron, std::size_t>> order;
    for (std::size_t t = 0; t < found.tetrahedra.size(); ++t) {
        Tetrahedron nodes = found.tetrahedra[t];
        std::ranges::sort(nodes);
        order.emplace_back(nodes, t);
    }
    std::ranges::sort(order);
    std::vector<bool> repeated(order.size(), false);
    for (std::size_t i = 1; i < order.size(); ++i)
        if (order[i].first == order[i - 1].first) repeated[order[i].second] = true;
    std::size_t kept = 0;
    for (std::size_t t = 0; t < repeated.size(); ++t) {
        if (repeated[t]) continue;
        found.tetrahedra[kept] = found.tetrahedra[t];
        if (!found.regions.empty()) found.regions[kept] = found.regions[t];
        ++kept;
    }
    found.tetrahedra.resize(kept);
    if (!found.regions.empty()) found.regions.resize(kept);
    return static_cast<std::int64_t>(repeated.size() - kept);
}

// Moves the nodes in use and the tetrahedra over; returns the number of nodes left behind.
std::int64_t take_used_nodes(FoundTetrahedra& found, TetMesh& mesh) {
    std::vector<std::int32_t> index(found.points.size(), -1);
    for (const Tetrahedron& tet : found.tetrahedra)
        for (const std::int32_t node : tet) index[node] = 0;
    for (std::size_t node = 0; node < index.size(); ++node) {
        if (index[node] < 0) continue;
        index[node] = static_cast<std::int32_t>(mesh.rest_positions.size());
        mesh.rest_positions.push_back(found.points[node]);
    }
    mesh.tetrahedra = std::move(found.tetrahedra);
    for (Tetrahedron& tet : mesh.tetrahedra)
        for (std::int32_t& node : tet) node = index[node];
    return static_cast<std::int64_t>(index.size() - mesh.rest_positions.size());
}

// Turns inverted tetrahedra; refuses those without volume.
std::int64_t orient(TetMesh& mesh, const std::string& culprit) {
    constexpr double flat =
        1e-9;  // of the cube of the longest edge: what float32 positions cannot tell from 0
    std::int64_t turned = 0;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        Tetrahedron& tet = mesh.tetrahedra[t];
        double longest = 0;
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = 0; b < a; ++b)
                longest =
                    std::max(longest, (mesh.rest_positions[tet[a]] - mesh.rest_positions[tet[b]]).norm());
        const double volume = six_volume(mesh, t);
        if (!(std::abs(volume) > flat * longest * longest * longest))
            throw InvalidInput({culprit,
                                fmt::format("tetrahedron {} at {} has no volume", t, place_of(mesh, t)),
                                "a volume above 0", "improve the mesh where it was made, or remesh"});
        if (volume > 0) continue;
        std::swap(tet[2], tet[3]);
        ++turned;
    }
    return turned;
}

// At each face at most two tetrahedra, one on each side.
void require_proper_faces(const TetMesh& mesh, const std::string& culprit) {
    const auto apex_side = [&](const TetFace& face) {
        const auto point = [&](std::int32_t node) { return mesh.rest_positions[node]; };
        const Eigen::Vector3d a = point(face.sorted_nodes[0]);
        const Eigen::Vector3d normal =
            (point(face.sorted_nodes[1]) - a).cross(point(face.sorted_nodes[2]) - a);
        return normal.dot(point(mesh.tetrahedra[face.tet][face.face]) - a) > 0;
    };
    const std::vector<TetFace> faces = sorted_faces(mesh);
    for (std::size_t i = 1; i < faces.size(); ++i) {
        if (faces[i].sorted_nodes != faces[i - 1].sorted_nodes) continue;
        if (i > 1 && faces[i].sorted_nodes == faces[i - 2].sorted_nodes)
            throw InvalidInput(
                {culprit,
                 fmt::format("more than two tetrahedra share a face at {}", place_of(mesh, faces[i].tet)),
                 "two at most", "remove what lies on each other, or remesh"});
        if (apex_side(faces[i]) == apex_side(faces[i - 1]))
            throw InvalidInput({culprit,
                                fmt::format("tetrahedra {} and {} overlap at {}", faces[i - 1].tet,
                                            faces[i].tet, place_of(mesh, faces[i].tet)),
                                "one on each side of their face",
                                "untangle the mesh where it was made, or remesh"});
    }
}

// Faces that lie on each other without sharing nodes: the body would come apart there.
void require_no_cracks(const TriangleMesh& surface, const std::string& culprit) {
    using Place = std::array<double, 3>;
    std::vector<std::array<Place, 3>> faces;
    for (const Triangle& t : surface.triangles) {
        std::array<Place, 3> corners;
        for (std::size_t c = 0; c < 3; ++c) {
            const Eigen::Vector3d& p = surface.vertices[t[c]];
            corners[c] = {p.x(), p.y(), p.z()};
        }
        std::ranges::sort(corners);
        faces.push_back(corners);
    }
    std::ranges::sort(faces);
    std::int64_t cracks = 0;
    Place first{};
    for (std::size_t i = 1; i < faces.size(); ++i)
        if (faces[i] == faces[i - 1] && cracks++ == 0) first = faces[i][0];
    if (cracks > 0)
        throw InvalidInput(
            {culprit,
             fmt::format("{} pairs of faces lie on each other without sharing nodes, the first at "
                         "({:.2f}, {:.2f}, {:.2f})",
                         cracks, first[0], first[1], first[2]),
             "shared nodes, so that the parts hold together",
             "join duplicate nodes where it was made ('Coherence Mesh;' in Gmsh)"});
}

void require_no_overlap(const TriangleMesh& surface, const std::string& culprit) {
    if (const auto place = place_of_overlap(surface))
        throw InvalidInput({culprit,
                            fmt::format("parts of it lie in the same place, at ({:.2f}, {:.2f}, {:.2f})",
                                        place->x(), place->y(), place->z()),
                            "one tetrahedron at each place",
                            "remove what is there twice, or join the parts where it was made"});
}

constexpr std::int32_t last_label = 65535;

// Takes the lowest label that is free.
std::int32_t take_free_label(std::set<std::int32_t>& taken, const std::string& culprit) {
    std::int32_t free = 1;
    for (const std::int32_t label : taken) {
        if (label > free) break;
        if (label == free) ++free;
    }
    if (free > last_label)
        throw InvalidInput({culprit, "leaves no label free", fmt::format("{} labels at most", last_label),
                            "join regions where it was made"});
    taken.insert(free);
    return free;
}

// Values that are no labels get free ones; then every value gets its name.
void name_regions(TetMesh& mesh, const FoundTetrahedra& found, const ImportedMeshOptions& options,
                  const std::string& culprit, const NoteSink& note) {
    mesh.regions =
        found.regions.empty() ? std::vector<std::int32_t>(mesh.tetrahedra.size(), 1) : found.regions;
    const std::set<std::int32_t> values(mesh.regions.begin(), mesh.regions.end());
    for (const auto& [value, name] : options.region_names)
        if (!values.contains(value))
            throw InvalidInput({culprit, fmt::format("has no region {} to call '{}'", value, name),
                                fmt::format("one of {}", fmt::join(values, ", ")), ""});
    std::set<std::int32_t> taken(values.lower_bound(1), values.upper_bound(last_label));
    std::map<std::int32_t, std::int32_t> label_of;
    for (const std::int32_t value : values) {
        Label label{value, fmt::format("region {}", value), {}};
        if (const auto known = std::ranges::find(found.names, value, &Label::value);
            known != found.names.end())
            label = *known;
        if (const auto own = options.region_names.find(value); own != options.region_names.end())
            label.name = own->second;
        if (value < 1 || value > last_label) {
            label.value = take_free_label(taken, culprit);
            if (note) note(fmt::format("{}: region {} became {}", culprit, value, label.value));
        }
        if (label.colour == std::array<float, 3>{}) label.colour = default_label_colour(label.value);
        label_of[value] = label.value;
        mesh.region_names.push_back(label);
    }
    for (std::int32_t& region : mesh.regions) region = label_of.at(region);
    std::ranges::sort(mesh.region_names, {}, &Label::value);
}

}  // namespace

TetMesh read_imported_tetrahedra(const std::filesystem::path& path, const ImportedMeshOptions& options,
                                 const NoteSink& note) {
    const std::string culprit = path.string();
    const auto say = [&](std::int64_t count, const char* what) {
        if (count > 0 && note) note(fmt::format("{}: {} {}", culprit, count, what));
    };
    FoundTetrahedra found = read_solids(path);
    if (!found.solid.empty())
        throw InvalidInput(
            {culprit, "holds other solid cells: " + listed(found.solid),
             fmt::format("linear tetrahedra only (it has {})", found.tetrahedra.size()),
             "save it with linear tetrahedra (Gmsh: Mesh.ElementOrder = 1, Mesh.RecombineAll = 0)"});
    require_tetrahedra(found, culprit);
    if (!found.flat.empty() && note) note(culprit + ": ignored " + listed(found.flat));

    TetMesh mesh;
    say(drop_repeated_tetrahedra(found), "tetrahedra that were there twice left out");
    say(take_used_nodes(found, mesh), "unused nodes left out");
    place(mesh.rest_positions, options, found.space, culprit, note);
    if (const std::int64_t turned = orient(mesh, culprit); turned > 0 && note)
        note(fmt::format("{}: {} of {} tetrahedra were inverted and are turned", culprit, turned,
                         mesh.tetrahedra.size()));
    require_proper_faces(mesh, culprit);
    const TriangleMesh surface = boundary_surface(mesh).surface;
    require_no_cracks(surface, culprit);
    require_no_overlap(surface, culprit);
    say(split_hinges(mesh), "nodes doubled where parts touch in a point or edge only");
    name_regions(mesh, found, options, culprit, note);
    mark_surface(mesh);
    return mesh;
}

UnrepairedTetrahedra read_unrepaired_tetrahedra(const std::filesystem::path& path,
                                                const ImportedMeshOptions& options, const NoteSink& note) {
    const std::string culprit = path.string();
    FoundTetrahedra found = read_solids(path);
    require_tetrahedra(found, culprit);
    UnrepairedTetrahedra read{.mesh = {}, .other_cells = found.flat};
    read.other_cells.insert(found.solid.begin(), found.solid.end());
    if (const std::int64_t unused = take_used_nodes(found, read.mesh); unused > 0 && note)
        note(fmt::format("{}: {} unused nodes left out", culprit, unused));
    place(read.mesh.rest_positions, options, found.space, culprit, note);
    name_regions(read.mesh, found, options, culprit, note);
    mark_surface(read.mesh);
    return read;
}

void adopt_labels(TetMesh& mesh, const LabelMap& map) {
    std::set<std::int32_t> taken;
    for (const Label& label : map.names) taken.insert(label.value);
    std::map<std::int32_t, std::int32_t> value_of;
    bool any = false;
    for (Label& region : mesh.region_names) {
        const auto label = find_label(map, region.name);
        any = any || label;
        const std::int32_t before = region.value;
        region = label ? *label : Label{take_free_label(taken, "label map"), region.name, region.colour};
        value_of[before] = region.value;
    }
    if (!any) {
        std::vector<std::string> names;
        for (const Label& label : map.names) names.push_back("'" + label.name + "'");
        throw InvalidInput({fmt::format("mesh with region '{}'", mesh.region_names.front().name),
                            "no region has the name of a label", fmt::format("{}", fmt::join(names, ", ")),
                            "name the regions, for example 1=liver"});
    }
    for (std::int32_t& region : mesh.regions) region = value_of.at(region);
    std::ranges::sort(mesh.region_names, {}, &Label::value);
    mesh.outside_labels = outside_labels(mesh, map);
    mesh.outside_names.clear();
    const std::set<std::int32_t> seen(mesh.outside_labels.begin(), mesh.outside_labels.end());
    for (const Label& label : map.names)
        if (seen.contains(label.value)) mesh.outside_names.push_back(label);
}

}  // namespace palpate::meshing
