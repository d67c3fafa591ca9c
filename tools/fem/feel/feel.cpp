// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/feel/feel.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <map>
#include <optional>

#include "formats/model/contact/surface_walk.hpp"
#include "formats/model/regions.hpp"
#include "tools/fem/feel/pressing.hpp"

namespace palpate::fem {
namespace {

using Eigen::Vector3d;

// Cosine between the normals of places that a hand slides over without turning round: 60 degrees.
constexpr double same_side = 0.5;

// The other region that shares most of this one's border, by area; none if it lies apart.
std::optional<std::int32_t> surrounding_region(const TetMesh& mesh, std::int32_t region) {
    std::map<std::array<std::int32_t, 3>, double> border;  // faces that one tetrahedron of the region has
    const auto for_each_face = [&](bool inside, const auto& visit) {
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
            if ((mesh.regions[t] == region) != inside) continue;
            for (const auto& corners : tetrahedron_faces) {
                std::array<std::int32_t, 3> face{};
                for (std::size_t c = 0; c < 3; ++c) face[c] = mesh.tetrahedra[t][corners[c]];
                std::ranges::sort(face);
                visit(face, mesh.regions[t]);
            }
        }
    };
    for_each_face(true, [&](const auto& face, std::int32_t) {
        const auto p = [&](std::size_t c) -> const Vector3d& { return mesh.rest_positions[face[c]]; };
        if (!border.try_emplace(face, (p(1) - p(0)).cross(p(2) - p(0)).norm() / 2).second) border.erase(face);
    });
    std::map<std::int32_t, double> shared;
    for_each_face(false, [&](const auto& face, std::int32_t other) {
        if (const auto found = border.find(face); found != border.end()) shared[other] += found->second;
    });
    if (shared.empty()) return std::nullopt;
    return std::ranges::max_element(shared, {}, [](const auto& entry) { return entry.second; })->first;
}

std::vector<Vector3d> positions_in(const TetMesh& mesh, std::int32_t region) {
    std::vector<Vector3d> positions;
    for (const std::int32_t node : nodes_of_region(mesh, region))
        positions.push_back(mesh.rest_positions[node]);
    return positions;
}

// Of the point of `points` with the least, or with the most distance to p.
double least_distance(const std::vector<Vector3d>& points, const Vector3d& p) {
    double squared = (points.front() - p).squaredNorm();
    for (const Vector3d& point : points) squared = std::min(squared, (point - p).squaredNorm());
    return std::sqrt(squared);
}
double most_distance(const std::vector<Vector3d>& points, const Vector3d& p) {
    double squared = 0;
    for (const Vector3d& point : points) squared = std::max(squared, (point - p).squaredNorm());
    return std::sqrt(squared);
}

// The vertices nearest to points among those that can be pressed.
std::vector<std::int32_t> nearest_vertices(const DeformableBody& body, const Pressing& pressing,
                                           const std::vector<Vector3d>& points) {
    std::vector<std::pair<double, std::int32_t>> by_distance;
    const auto& vertices = body.boundary.surface.vertices;
    for (std::size_t v = 0; v < vertices.size(); ++v)
        if (can_be_pressed(pressing, static_cast<std::int32_t>(v)))
            by_distance.emplace_back(least_distance(points, vertices[v]), static_cast<std::int32_t>(v));
    std::ranges::sort(by_distance);
    by_distance.resize(std::min(by_distance.size(), most_felt_vertices));
    std::vector<std::int32_t> nearest;
    for (const auto& [distance, vertex] : by_distance) nearest.push_back(vertex);
    return nearest;
}

// The body without its compliance, which a solution does not read.
DeformableBody uncondensed(const DeformableBody& body) {
    DeformableBody copy;
    copy.name = body.name;
    copy.mesh = body.mesh;
    copy.element_order = body.element_order;
    copy.materials = body.materials;
    copy.fixed_nodes = body.fixed_nodes;
    copy.boundary = body.boundary;
    copy.contact_nodes = body.contact_nodes;
    return copy;
}

Material& material_in(DeformableBody& body, std::int32_t region) {
    return std::ranges::find(body.materials, region, &RegionMaterial::region)->material;
}

// Half of what lies between the 16th and the 84th hundredth of values, by their median: one standard
// deviation of normal ones.
double variation_of(std::vector<double> values) {
    if (values.empty()) return 0;
    std::ranges::sort(values);
    const auto at = [&](double part) {
        return values[static_cast<std::size_t>(std::lround(part * static_cast<double>(values.size() - 1)))];
    };
    return (at(0.84) - at(0.16)) / 2 / at(0.5);
}

// What a region makes of the stiffness; nothing if it lies apart or there is nothing to press.
std::optional<FeltRegion> felt_region(const DeformableBody& body, const Pressing& pressing,
                                      const std::vector<float>& stiffness, std::int32_t region, int threads) {
    const auto around = surrounding_region(body.mesh, region);
    if (!around) return std::nullopt;
    const std::vector<Vector3d> nodes = positions_in(body.mesh, region);
    const std::vector<std::int32_t> near = nearest_vertices(body, pressing, nodes);
    if (near.empty()) return std::nullopt;
    DeformableBody without = uncondensed(body);
    material_in(without, region) = material_in(without, *around);
    const std::vector<double> compliances = solved_compliances(without, pressing, near, threads);
    const double modulus = surface_contact_modulus(without);

    std::optional<FeltRegion> most;
    std::vector<double> plain(stiffness.begin(), stiffness.end());  // without the region, as far as is known
    const auto& vertices = body.boundary.surface.vertices;
    for (std::size_t k = 0; k < near.size(); ++k) {
        const auto v = static_cast<std::size_t>(near[k]);
        plain[v] = pressed_stiffness(pressing, compliances[k], modulus);
        const FeltRegion felt{.region = region,
                              .vertex = near[k],
                              .depth = least_distance(nodes, vertices[v]),
                              .stiffness = static_cast<double>(stiffness[v]),
                              .stiffness_without = plain[v],
                              .variation = 0};
        if (!most || std::abs(contrast_of(felt)) > std::abs(contrast_of(*most))) most = felt;
    }
    const auto at = static_cast<std::size_t>(most->vertex);
    const auto faces_alike = [&](std::int32_t v) {
        return pressing.normals[static_cast<std::size_t>(v)].dot(pressing.normals[at]) > same_side;
    };
    std::vector<double> nearby;
    SurfaceWalk walk(body.boundary.surface);
    for (const std::int32_t v :
         walk.within(most->vertex, 2 * most_distance(nodes, vertices[at]), faces_alike))
        if (plain[static_cast<std::size_t>(v)] > 0) nearby.push_back(plain[static_cast<std::size_t>(v)]);
    most->variation = variation_of(std::move(nearby));
    return most;
}

// Gives to a region, of the same mesh, the tetrahedra whose centroid `back` takes into it as it is, and those
// that it leaves to `around`.
void reshape(TetMesh& mesh, std::int32_t region, std::int32_t around,
             const std::function<Vector3d(const Vector3d&)>& back) {
    struct Piece {
        Vector3d corner;
        Eigen::Matrix3d to_weights;  // of the other three corners
    };
    std::vector<Piece> pieces;
    const auto corner = [&](std::size_t t, std::size_t c) -> const Vector3d& {
        return mesh.rest_positions[static_cast<std::size_t>(mesh.tetrahedra[t][c])];
    };
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        if (mesh.regions[t] != region) continue;
        Eigen::Matrix3d edges;
        for (std::size_t c = 1; c < 4; ++c)
            edges.col(static_cast<Eigen::Index>(c) - 1) = corner(t, c) - corner(t, 0);
        pieces.push_back({corner(t, 0), edges.inverse()});
    }
    const auto is_inside = [&](const Vector3d& p) {
        return std::ranges::any_of(pieces, [&](const Piece& piece) {
            const Vector3d weights = piece.to_weights * (p - piece.corner);
            return weights.minCoeff() >= 0 && weights.sum() <= 1;
        });
    };
    std::vector<std::int32_t> regions = mesh.regions;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        if (regions[t] != region && regions[t] != around) continue;
        const Vector3d centroid = (corner(t, 0) + corner(t, 1) + corner(t, 2) + corner(t, 3)) / 4;
        regions[t] = is_inside(back(centroid)) ? region : around;
    }
    mesh.regions = std::move(regions);
}

}  // namespace

Feel feel_of(const DeformableBody& body, double tool_radius, int threads) {
    const Pressing pressing = pressing_of(body, tool_radius, feel_depth(tool_radius));
    const std::vector<double> compliances = spread_compliances(body, pressing, threads);
    const double modulus = surface_contact_modulus(body);
    Feel feel{.tool_radius = tool_radius, .depth = pressing.depth, .stiffness = {}, .regions = {}};
    for (std::size_t v = 0; v < compliances.size(); ++v)
        feel.stiffness.push_back(
            compliances[v] > 0 ? static_cast<float>(pressed_stiffness(pressing, compliances[v], modulus))
                               : 0.0F);
    const std::int32_t main = main_region(body.mesh);
    for (const Label& label : body.mesh.region_names)
        if (label.value != main)
            if (const auto felt = felt_region(body, pressing, feel.stiffness, label.value, threads))
                feel.regions.push_back(*felt);
    return feel;
}

std::vector<FeltTrial> felt_trials(const DeformableBody& body, const FeltRegion& felt, int threads) {
    constexpr double stiffer = 2, larger = 1.5, nearer = 0.5;
    const double tool_radius = body.feel->tool_radius, depth = body.feel->depth;
    const auto around = surrounding_region(body.mesh, felt.region);
    if (!around) return {};
    const Pressing pressing = pressing_of(body, tool_radius, depth);
    std::vector<FeltTrial> trials;
    const auto add = [&](std::string change, const FeltRegion& tried) {
        trials.push_back({std::move(change), tried, verdict_of(tried, depth)});
    };
    const auto solve = [&](std::string change, double new_depth, const DeformableBody& other) {
        const std::array vertices{felt.vertex};
        FeltRegion tried = felt;
        tried.depth = new_depth;
        tried.stiffness =
            pressed_stiffness(pressing, solved_compliances(other, pressing, vertices, threads)[0],
                              surface_contact_modulus(other));
        add(std::move(change), tried);
    };
    const DeformableBody plain = uncondensed(body);
    DeformableBody other = plain;
    Material& material = material_in(other, felt.region);
    const bool softer = felt.stiffness < felt.stiffness_without;
    material.youngs_modulus *= softer ? 1 / stiffer : stiffer;
    solve(fmt::format("{:g} times as {}", stiffer, softer ? "soft" : "stiff"), felt.depth, other);

    const std::vector<Vector3d> nodes = positions_in(body.mesh, felt.region);
    const Vector3d place = body.boundary.surface.vertices[static_cast<std::size_t>(felt.vertex)];
    const Vector3d nearest =
        *std::ranges::min_element(nodes, {}, [&](const Vector3d& p) { return (p - place).squaredNorm(); });
    const Vector3d shift = (1 - nearer) * (place - nearest);
    other = plain;
    reshape(other.mesh, felt.region, *around, [&](const Vector3d& p) -> Vector3d { return p - shift; });
    solve("half as deep", nearer * felt.depth, other);

    Vector3d centre = Vector3d::Zero();
    for (const Vector3d& p : nodes) centre += p / static_cast<double>(nodes.size());
    other = plain;
    reshape(other.mesh, felt.region, *around,
            [&](const Vector3d& p) -> Vector3d { return centre + (p - centre) / larger; });
    solve(fmt::format("{:g} times as large", larger),
          std::max(0.0, felt.depth - (larger - 1) * (nearest - centre).norm()), other);

    // The same discs' compliances, from what was felt, under another tool.
    const std::array vertices{felt.vertex};
    DeformableBody without = plain;
    material_in(without, felt.region) = material_in(without, *around);
    const double with_compliance = solved_compliances(plain, pressing, vertices, threads)[0],
                 without_compliance = solved_compliances(without, pressing, vertices, threads)[0];
    for (const double radius : {tool_radius / 2, tool_radius * 2}) {
        Pressing with_tool = pressing;
        with_tool.tool_radius = radius;
        if (radius > tool_radius && pressing_of(body, radius, depth).disc.reach > pressing.disc.reach)
            continue;
        FeltRegion tried = felt;
        tried.stiffness = pressed_stiffness(with_tool, with_compliance, surface_contact_modulus(body));
        tried.stiffness_without =
            pressed_stiffness(with_tool, without_compliance, surface_contact_modulus(without));
        add(fmt::format("a tool of {:g} mm radius", radius), tried);
    }
    return trials;
}

}  // namespace palpate::fem
