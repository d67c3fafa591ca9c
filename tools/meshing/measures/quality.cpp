// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/measures/quality.hpp"

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <map>
#include <numbers>

#include "formats/model/disjoint_sets.hpp"
#include "tools/meshing/measures/tet_faces.hpp"

namespace palpate::meshing {
namespace {

struct DirectedEdge {
    std::int32_t low, high;
    bool forwards;  // from low to high
    auto operator<=>(const DirectedEdge&) const = default;
};

std::array<Eigen::Vector3d, 4> corners_of(const TetMesh& mesh, std::size_t t) {
    std::array<Eigen::Vector3d, 4> p;
    for (std::size_t c = 0; c < 4; ++c) p[c] = mesh.rest_positions[mesh.tetrahedra[t][c]];
    return p;
}

// The outward area vectors of the faces opposite to each corner.
std::array<Eigen::Vector3d, 4> face_vectors(const std::array<Eigen::Vector3d, 4>& p) {
    std::array<Eigen::Vector3d, 4> areas;
    for (std::size_t f = 0; f < 4; ++f) {
        const auto& [a, b, c] = tetrahedron_faces[f];
        areas[f] = 0.5 * (p[b] - p[a]).cross(p[c] - p[a]);
    }
    return areas;
}

// The angle between two faces is pi less the angle between their outward normals.
std::array<double, 6> dihedral_angles_deg(const std::array<Eigen::Vector3d, 4>& p) {
    const std::array<Eigen::Vector3d, 4> face = face_vectors(p);
    std::array<double, 6> angles{};
    std::size_t n = 0;
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b)
            angles[n++] =
                std::atan2(face[a].cross(face[b]).norm(), -face[a].dot(face[b])) * 180 / std::numbers::pi;
    return angles;
}

// 3 r / R with inradius r = 3 V / S; the circumcentre c solves 2 (p_i - p_0) . (c - p_0) = |p_i - p_0|².
double radius_ratio(const std::array<Eigen::Vector3d, 4>& p, double volume) {
    if (!(volume > 0)) return 0;
    double surface = 0;
    for (const Eigen::Vector3d& face : face_vectors(p)) surface += face.norm();
    Eigen::Matrix3d edges;
    Eigen::Vector3d squares;
    for (std::size_t i = 1; i < 4; ++i) {
        edges.row(static_cast<Eigen::Index>(i) - 1) = p[i] - p[0];
        squares[static_cast<Eigen::Index>(i) - 1] = (p[i] - p[0]).squaredNorm();
    }
    const double circumradius = edges.partialPivLu().solve(0.5 * squares).norm();
    return 9 * volume / (surface * circumradius);
}

template <typename Cell>
EdgeLengths edge_lengths(const std::vector<Eigen::Vector3d>& points, const std::vector<Cell>& cells) {
    std::vector<std::array<std::int32_t, 2>> edges;
    for (const Cell& cell : cells)
        for (std::size_t a = 0; a < cell.size(); ++a)
            for (std::size_t b = a + 1; b < cell.size(); ++b)
                edges.push_back({std::min(cell[a], cell[b]), std::max(cell[a], cell[b])});
    std::ranges::sort(edges);
    const auto repeated = std::ranges::unique(edges);
    edges.erase(repeated.begin(), repeated.end());
    EdgeLengths lengths{.shortest = (points[edges[0][0]] - points[edges[0][1]]).norm()};
    for (const auto& [a, b] : edges) {
        const double length = (points[a] - points[b]).norm();
        lengths.shortest = std::min(lengths.shortest, length);
        lengths.longest = std::max(lengths.longest, length);
        lengths.mean += length / static_cast<double>(edges.size());
    }
    return lengths;
}

}  // namespace

EdgeLengths edge_lengths(const TetMesh& mesh) {
    return edge_lengths(mesh.rest_positions, mesh.tetrahedra);
}

EdgeLengths edge_lengths(const TriangleMesh& surface) {
    return edge_lengths(surface.vertices, surface.triangles);
}

TetShape tet_shape(const TetMesh& mesh, std::size_t t) {
    const auto p = corners_of(mesh, t);
    return {dihedral_angles_deg(p), radius_ratio(p, six_volume(mesh, t) / 6)};
}

// The sine of the dihedral angle at an edge e between faces of areas A and B is 1.5 V |e| / (A B), which is
// the same for an angle and for what it lacks to 180°.
double flatness_deg(const TetMesh& mesh, std::size_t t) {
    const auto p = corners_of(mesh, t);
    const std::array<Eigen::Vector3d, 4> face = face_vectors(p);
    const double volume = six_volume(mesh, t) / 6;
    std::array<double, 4> squared_area{};
    for (std::size_t f = 0; f < 4; ++f) squared_area[f] = face[f].squaredNorm();
    double smallest = 1;
    for (std::size_t a = 0; a < 4; ++a)
        for (std::size_t b = a + 1; b < 4; ++b) {
            // The faces opposite to the two other corners meet in this edge.
            const std::size_t c = a == 0 ? (b == 1 ? 2 : 1) : 0, d = 6 - a - b - c;
            smallest = std::min(smallest, 2.25 * volume * volume * (p[b] - p[a]).squaredNorm() /
                                              (squared_area[c] * squared_area[d]));
        }
    return std::asin(std::sqrt(smallest)) * 180 / std::numbers::pi;
}

SurfaceQuality measure(const TriangleMesh& surface) {
    SurfaceQuality quality;
    std::vector<DirectedEdge> edges;
    edges.reserve(3 * surface.triangles.size());
    DisjointSets pieces(surface.vertices.size());
    std::vector<bool> used(surface.vertices.size(), false);
    for (const Triangle& t : surface.triangles) {
        const auto vertex = [&](std::size_t c) { return static_cast<std::size_t>(t[c]); };
        const auto point = [&](std::size_t c) -> const Eigen::Vector3d& {
            return surface.vertices[vertex(c)];
        };
        const Eigen::Vector3d area = 0.5 * (point(1) - point(0)).cross(point(2) - point(0));
        quality.degenerate_triangles += !(area.norm() > 0) || t[0] == t[1] || t[1] == t[2] || t[2] == t[0];
        quality.area += area.norm();
        quality.volume += area.dot(point(0)) / 3;
        for (std::size_t c = 0; c < 3; ++c) {
            const std::int32_t from = t[c], to = t[(c + 1) % 3];
            edges.push_back({std::min(from, to), std::max(from, to), from < to});
            pieces.join(vertex(0), vertex(c));
            used[vertex(c)] = true;
        }
    }
    std::ranges::sort(edges);
    for (std::size_t i = 0; i < edges.size();) {
        std::size_t end = i, forwards = 0;
        for (; end < edges.size() && edges[end].low == edges[i].low && edges[end].high == edges[i].high;
             ++end)
            forwards += edges[end].forwards;
        quality.open_edges += end - i == 1;
        quality.non_manifold_edges += end - i > 2;
        quality.misoriented_edges += end - i == 2 && forwards != 1;
        i = end;
    }
    for (std::size_t v = 0; v < used.size(); ++v) quality.components += used[v] && pieces.root(v) == v;
    return quality;
}

std::vector<std::int32_t> face_components(const TetMesh& mesh) {
    const std::vector<TetFace> faces = sorted_faces(mesh);
    DisjointSets pieces(mesh.tetrahedra.size());
    for (std::size_t i = 1; i < faces.size(); ++i)
        if (faces[i].sorted_nodes == faces[i - 1].sorted_nodes) pieces.join(faces[i].tet, faces[i - 1].tet);
    const std::vector<std::size_t> number = pieces.numbered();
    return {number.begin(), number.end()};
}

MeshQuality measure(const TetMesh& mesh) {
    MeshQuality quality;
    std::vector<double> angles;
    angles.reserve(6 * mesh.tetrahedra.size());
    std::map<std::int32_t, double> volumes;
    std::vector<WorstTetrahedron> flattest;
    quality.min_radius_ratio = 1;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const auto p = corners_of(mesh, t);
        const auto dihedrals = dihedral_angles_deg(p);
        angles.insert(angles.end(), dihedrals.begin(), dihedrals.end());
        const auto [low, high] = std::ranges::minmax(dihedrals);
        flattest.push_back({static_cast<std::int32_t>(t), low, high, (p[0] + p[1] + p[2] + p[3]) / 4});
        const double volume = six_volume(mesh, t) / 6;
        volumes[mesh.regions[t]] += volume;
        quality.inverted += !(volume > 0);
        const double ratio = radius_ratio(p, volume);
        quality.min_radius_ratio = std::min(quality.min_radius_ratio, ratio);
        quality.mean_radius_ratio += ratio / static_cast<double>(mesh.tetrahedra.size());
    }
    std::ranges::stable_sort(flattest, {}, [](const WorstTetrahedron& tet) {
        return std::min(tet.min_dihedral_deg, 180 - tet.max_dihedral_deg);
    });
    flattest.resize(std::min<std::size_t>(5, flattest.size()));
    quality.worst = std::move(flattest);
    for (const auto& [region, volume] : volumes) quality.region_volumes.push_back({region, volume});

    std::ranges::sort(angles);
    quality.min_dihedral_deg = angles.front();
    quality.max_dihedral_deg = angles.back();
    constexpr std::array<double, 5> fractions{0.01, 0.05, 0.5, 0.95, 0.99};
    for (std::size_t i = 0; i < fractions.size(); ++i)
        quality.dihedral_percentiles_deg[i] =
            angles[static_cast<std::size_t>(fractions[i] * static_cast<double>(angles.size() - 1))];
    for (const double angle : angles)
        ++quality.dihedral_histogram[std::min<std::size_t>(17, static_cast<std::size_t>(angle / 10))];

    const std::vector<std::int32_t> pieces = face_components(mesh);
    quality.components = std::ranges::max(pieces) + 1;
    quality.boundary = measure(boundary_surface(mesh).surface);
    return quality;
}

}  // namespace palpate::meshing
