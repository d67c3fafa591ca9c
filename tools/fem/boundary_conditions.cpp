// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/boundary_conditions.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <charconv>
#include <functional>
#include <map>
#include <numeric>
#include <optional>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

std::vector<double> parse_numbers(std::string_view text, std::size_t count, std::string_view rule) {
    std::vector<double> numbers;
    const char* at = text.data();
    const char* const end = text.data() + text.size();
    while (at < end) {
        double value = 0;
        const auto [next, error] = std::from_chars(at, end, value);
        if (error != std::errc{}) break;
        numbers.push_back(value);
        at = next;
        if (at < end && *at == ',') ++at;
    }
    if (at != end || numbers.size() != count)
        throw UsageError({"fixed rule '" + std::string(rule) + "'", "its numbers cannot be read",
                          std::to_string(count) + " numbers separated by commas, in LPS mm", ""});
    return numbers;
}

std::string point_text(const Eigen::Vector3d& p) {
    const auto rounded = [](double x) { return std::to_string(static_cast<long>(std::lround(x))); };
    return "(" + rounded(p.x()) + ", " + rounded(p.y()) + ", " + rounded(p.z()) + ") mm";
}

std::string rule_text(const FixedRule& rule) {
    if (const auto* touching = std::get_if<TouchingLabel>(&rule)) return "touching '" + touching->name + "'";
    if (std::holds_alternative<InsideBox>(rule)) return "box";
    if (std::holds_alternative<InsideSphere>(rule)) return "sphere";
    return "plane";
}

std::int32_t outside_value(const TetMesh& mesh, const std::string& name) {
    if (mesh.outside_labels.empty())
        throw InvalidInput({"fixed rule touching '" + name + "'",
                            "the mesh does not tell what lies around it", "",
                            "mesh it from a label map, or hold it by box, sphere or plane"});
    if (name == "background") return 0;
    for (const Label& label : mesh.outside_names)
        if (label.name == name) return label.value;
    std::vector<std::string> known{"background"};
    for (const Label& label : mesh.outside_names) known.push_back(label.name);
    std::string near;
    for (const std::string& candidate : nearest_names(name, known))
        near += (near.empty() ? "" : ", ") + candidate;
    throw InvalidInput({"fixed rule touching '" + name + "'", "no such label touches the mesh", "",
                        "labels that do: " + near});
}

std::function<bool(std::size_t)> predicate(const TetMesh& mesh, const FixedRule& rule) {
    if (const auto* touching = std::get_if<TouchingLabel>(&rule))
        return [&mesh, value = outside_value(mesh, touching->name)](std::size_t node) {
            return mesh.outside_labels[node] == value;
        };
    if (const auto* box = std::get_if<InsideBox>(&rule))
        return [&mesh, box](std::size_t node) {
            const auto p = mesh.rest_positions[node].array();
            return (p >= box->lower.array()).all() && (p <= box->upper.array()).all();
        };
    if (const auto* sphere = std::get_if<InsideSphere>(&rule))
        return [&mesh, sphere](std::size_t node) {
            return (mesh.rest_positions[node] - sphere->center).norm() <= sphere->radius;
        };
    const auto& plane = std::get<BeyondPlane>(rule);
    return [&mesh, &plane](std::size_t node) {
        return (mesh.rest_positions[node] - plane.point).dot(plane.normal) >= 0;
    };
}

// The connected part of each node (parts numbered by their lowest node), by union-find over tetrahedra.
std::vector<std::int32_t> connected_parts(const TetMesh& mesh) {
    std::vector<std::int32_t> parent(mesh.rest_positions.size());
    std::iota(parent.begin(), parent.end(), 0);
    const auto root = [&](std::int32_t node) {
        while (parent[static_cast<std::size_t>(node)] != node) {
            auto& up = parent[static_cast<std::size_t>(node)];
            up = parent[static_cast<std::size_t>(up)];
            node = up;
        }
        return node;
    };
    for (const Tetrahedron& tet : mesh.tetrahedra)
        for (std::size_t c = 1; c < 4; ++c) {
            const std::int32_t a = root(tet[0]), b = root(tet[c]);
            parent[static_cast<std::size_t>(std::max(a, b))] = std::min(a, b);
        }
    for (std::size_t node = 0; node < parent.size(); ++node)
        parent[node] = root(static_cast<std::int32_t>(node));
    return parent;
}

// The rigid motion that nodes at these points, all held, still allow.
std::optional<std::string> free_motion(const std::vector<Eigen::Vector3d>& points, double size) {
    if (points.empty()) return "can translate and rotate freely: no node is held";
    Eigen::Vector3d mean = Eigen::Vector3d::Zero();
    for (const auto& p : points) mean += p / static_cast<double>(points.size());
    Eigen::Matrix3d spread = Eigen::Matrix3d::Zero();
    for (const auto& p : points) spread += (p - mean) * (p - mean).transpose();
    const Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d> axes(spread);
    // Held nodes closer together than a millionth of the body fix no direction.
    const double negligible = 1e-12 * size * size;
    if (axes.eigenvalues()[2] <= negligible)
        return "can rotate about its only held point " + point_text(mean);
    if (axes.eigenvalues()[1] <= negligible)
        return "can rotate about the line of its held nodes through " + point_text(mean);
    return std::nullopt;
}

}  // namespace

FixedRule parse_fixed_rule(std::string_view text) {
    const auto colon = text.find(':');
    const std::string_view kind = text.substr(0, colon);
    const std::string_view rest = colon == std::string_view::npos ? "" : text.substr(colon + 1);
    if (kind == "touching" && !rest.empty()) return TouchingLabel{std::string(rest)};
    if (kind == "box") {
        const auto n = parse_numbers(rest, 6, text);
        return InsideBox{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    }
    if (kind == "sphere") {
        const auto n = parse_numbers(rest, 4, text);
        return InsideSphere{{n[0], n[1], n[2]}, n[3]};
    }
    if (kind == "plane") {
        const auto n = parse_numbers(rest, 6, text);
        return BeyondPlane{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    }
    throw UsageError({"fixed rule '" + std::string(text) + "'", "unknown",
                      "touching:LABEL, box:x0,y0,z0,x1,y1,z1, sphere:x,y,z,r or plane:x,y,z,nx,ny,nz", ""});
}

std::vector<std::int32_t> fixed_nodes_of(const TetMesh& mesh, const BoundarySurface& boundary,
                                         std::span<const FixedRule> rules) {
    std::vector<bool> held(mesh.rest_positions.size(), false);
    for (const FixedRule& rule : rules) {
        const auto holds = predicate(mesh, rule);
        bool any = false;
        for (const std::int32_t node : boundary.nodes)
            if (holds(static_cast<std::size_t>(node))) held[static_cast<std::size_t>(node)] = any = true;
        if (!any)
            throw InvalidInput({"fixed rule " + rule_text(rule), "holds no surface node", "1 or more",
                                "check it against the mesh in ParaView; positions are LPS mm"});
    }
    std::vector<std::int32_t> nodes;
    for (std::size_t node = 0; node < held.size(); ++node)
        if (held[node]) nodes.push_back(static_cast<std::int32_t>(node));
    return nodes;
}

void require_no_rigid_motion(const TetMesh& mesh, std::span<const std::int32_t> fixed_nodes) {
    const auto part = connected_parts(mesh);
    std::map<std::int32_t, std::vector<Eigen::Vector3d>> held;
    std::map<std::int32_t, Eigen::AlignedBox3d> extent;
    for (std::size_t node = 0; node < part.size(); ++node) {
        held[part[node]];
        extent[part[node]].extend(mesh.rest_positions[node]);
    }
    for (const std::int32_t node : fixed_nodes)
        held[part[static_cast<std::size_t>(node)]].push_back(
            mesh.rest_positions[static_cast<std::size_t>(node)]);
    for (const auto& [root, points] : held) {
        const auto& box = extent[root];
        if (const auto motion = free_motion(points, box.diagonal().norm()))
            throw InvalidInput({held.size() == 1 ? "the body" : "its part around " + point_text(box.center()),
                                *motion + ", so its stiffness is singular",
                                "3 or more held nodes that are not on a line",
                                "add a fixed rule such as --fixed touching:LABEL or --fixed sphere:x,y,z,r"});
    }
}

}  // namespace palpate
