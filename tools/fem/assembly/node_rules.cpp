// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/assembly/node_rules.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <functional>
#include <iterator>
#include <optional>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"

namespace palpate::fem {
namespace {

std::optional<double> number_of(std::string_view text) {
    double value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size() || !std::isfinite(value))
        return std::nullopt;
    return value;
}

constexpr std::string_view box_meaning = "x0,y0,z0,x1,y1,z1", sphere_meaning = "x,y,z,radius",
                           plane_meaning = "x,y,z,nx,ny,nz", facing_meaning = "nx,ny,nz";

// `meaning`, such as "x,y,z,radius", tells how many numbers there must be.
void require_count(const std::vector<double>& numbers, std::string_view meaning, const std::string& rule) {
    const auto expected = static_cast<std::size_t>(std::ranges::count(meaning, ',')) + 1;
    if (numbers.size() != expected)
        throw UsageError({rule, "it has " + std::to_string(numbers.size()) + " numbers",
                          std::to_string(expected) + ": " + std::string(meaning) + " in LPS mm", ""});
}

std::vector<double> numbers_of(std::string_view text, std::string_view meaning, const std::string& rule) {
    std::vector<double> numbers;
    for (std::size_t begin = 0; begin <= text.size();) {
        const std::size_t comma = std::min(text.find(',', begin), text.size());
        const std::string_view word = text.substr(begin, comma - begin);
        const auto value = number_of(word);
        if (!value)
            throw UsageError({rule, "'" + std::string(word) + "' is not a number",
                              std::string(meaning) + " in LPS mm",
                              "separate numbers by commas, without blanks"});
        numbers.push_back(*value);
        begin = comma + 1;
    }
    return numbers;
}

InsideBox box_of(const std::vector<double>& n, const std::string& rule) {
    require_count(n, box_meaning, rule);
    const InsideBox box{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    if ((box.lower.array() > box.upper.array()).any())
        throw UsageError({rule, "its first corner is not below its second one",
                          "x0 <= x1, y0 <= y1, z0 <= z1",
                          "swap the coordinates that are the wrong way round"});
    return box;
}

InsideSphere sphere_of(const std::vector<double>& n, const std::string& rule) {
    require_count(n, sphere_meaning, rule);
    if (!(n[3] > 0)) throw UsageError({rule, "its radius is not positive", "more than 0 mm", ""});
    return {{n[0], n[1], n[2]}, n[3]};
}

BeyondPlane plane_of(const std::vector<double>& n, const std::string& rule) {
    require_count(n, plane_meaning, rule);
    const BeyondPlane plane{{n[0], n[1], n[2]}, {n[3], n[4], n[5]}};
    if (plane.normal.isZero(0))
        throw UsageError({rule, "its normal has no length", "a direction, such as 0,0,1", ""});
    return plane;
}

Facing facing_of(const std::vector<double>& n, const std::string& rule) {
    require_count(n, facing_meaning, rule);
    const Facing facing{{n[0], n[1], n[2]}};
    if (facing.direction.isZero(0))
        throw UsageError({rule, "it has no length", "a direction, such as 0,1,0", ""});
    return facing;
}

// "--fixed sphere:1,2,3.5,4".
std::string rule_text(std::string_view option, std::string_view kind, const std::vector<double>& numbers) {
    return fmt::format("{} {}:{}", option, kind, fmt::join(numbers, ","));
}

std::int32_t outside_value(const TetMesh& mesh, const std::string& name, const std::string& rule) {
    if (mesh.outside_labels.empty())
        throw InvalidInput(
            {rule, "the mesh does not tell what lies around it", "",
             "mesh it from a label map, or pick nodes by region, box, sphere, plane, facing or nodes"});
    if (name == "background") return 0;
    for (const Label& label : mesh.outside_names)
        if (label.name == name) return label.value;
    std::vector<std::string> known{"background"};
    for (const Label& label : mesh.outside_names) known.push_back(label.name);
    std::string near;
    for (const std::string& candidate : nearest_names(name, known))
        near += (near.empty() ? "" : ", ") + candidate;
    throw InvalidInput({rule, "no such label touches the mesh", "", "labels that do: " + near});
}

using Predicate = std::function<bool(std::int32_t)>;

// One way of telling surface nodes apart for each kind of rule but ListedNodes.
struct PredicateOf {
    const TetMesh& mesh;
    const BoundarySurface& boundary;
    const std::string& rule;

    const Eigen::Vector3d& at(std::int32_t node) const { return mesh.rest_positions[node]; }
    Predicate operator()(const TouchingLabel& touching) const {
        return [this, value = outside_value(mesh, touching.name, rule)](std::int32_t node) {
            return mesh.outside_labels[node] == value;
        };
    }
    Predicate operator()(const InsideBox& box) const {
        return [this, &box](std::int32_t node) {
            const auto p = at(node).array();
            return (p >= box.lower.array()).all() && (p <= box.upper.array()).all();
        };
    }
    Predicate operator()(const InsideSphere& sphere) const {
        return
            [this, &sphere](std::int32_t node) { return (at(node) - sphere.center).norm() <= sphere.radius; };
    }
    Predicate operator()(const BeyondPlane& plane) const {
        return [this, &plane](std::int32_t node) { return (at(node) - plane.point).dot(plane.normal) >= 0; };
    }
    Predicate operator()(const Facing& facing) const {
        constexpr double half_right_angle = 0.7071;  // its cosine
        const std::vector<Eigen::Vector3d> normals = surface_normals(boundary.surface);
        std::vector<bool> faces(mesh.rest_positions.size(), false);
        for (std::size_t vertex = 0; vertex < normals.size(); ++vertex)
            faces[boundary.nodes[vertex]] =
                normals[vertex].dot(facing.direction.normalized()) >= half_right_angle;
        return [faces = std::move(faces)](std::int32_t node) { return faces[node]; };
    }
    Predicate operator()(const OfRegion& region) const {
        const std::int32_t value = require_label(mesh.region_names, region.name, rule).value;
        std::vector<bool> corner(mesh.rest_positions.size(), false);
        for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
            if (mesh.regions[t] == value)
                for (const std::int32_t node : mesh.tetrahedra[t]) corner[node] = true;
        return [corner = std::move(corner)](std::int32_t node) { return corner[node]; };
    }
    Predicate operator()(const ListedNodes&) const { return {}; }
};

struct ListedNode {
    std::int32_t node;
    std::string place;  // "knob.txt:12"
};

std::string_view without_comment_and_blanks(std::string_view line) {
    constexpr std::string_view blanks = " \t\r";
    line = line.substr(0, line.find('#'));
    const std::size_t begin = std::min(line.find_first_not_of(blanks), line.size());
    line.remove_prefix(begin);
    return line.substr(0, line.find_last_not_of(blanks) + 1);
}

std::vector<ListedNode> read_node_list(const std::filesystem::path& file, std::size_t node_count,
                                       const std::string& rule) {
    constexpr std::uintmax_t most_bytes = 256 << 20;
    require_small_file(file, most_bytes);
    std::ifstream stream(file);
    if (!stream)
        throw InvalidInput({rule, "the file " + file.string() + " cannot be read",
                            "a text file of node indices", "check its name and permissions"});
    constexpr std::string_view byte_order_mark = "\xef\xbb\xbf";
    std::vector<ListedNode> nodes;
    std::size_t number = 0;
    for (std::string line; std::getline(stream, line);) {
        const std::string place = file.string() + ":" + std::to_string(++number);
        if (number == 1 && line.starts_with(byte_order_mark)) line.erase(0, byte_order_mark.size());
        const std::string_view word = without_comment_and_blanks(line);
        if (word.empty()) continue;
        std::int64_t node = -1;
        const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), node);
        if (error != std::errc{} || end != word.data() + word.size() || node < 0 ||
            node >= static_cast<std::int64_t>(node_count))
            throw InvalidInput({place, "'" + std::string(word.substr(0, 40)) + "' is not the index of a node",
                                "0 to " + std::to_string(node_count - 1) + ", one a line",
                                "indices count from 0; '#' begins a comment"});
        nodes.push_back({static_cast<std::int32_t>(node), place});
    }
    return nodes;
}

enum class Reach { surface, whole_mesh };

// Marks the nodes that a rule picks; `reach` tells whether a file may list interior ones.
void mark_nodes(const TetMesh& mesh, const BoundarySurface& boundary, const NodeRule& rule, Reach reach,
                std::vector<bool>& marked) {
    bool any = false;
    const auto mark = [&](std::int32_t node) { marked[node] = any = true; };
    if (const auto* listed = std::get_if<ListedNodes>(&rule.pick)) {
        for (const auto& [node, place] :
             read_node_list(listed->file, mesh.rest_positions.size(), rule.text)) {
            if (reach == Reach::surface && !std::ranges::binary_search(boundary.nodes, node))
                throw InvalidInput({place, "node " + std::to_string(node) + " lies inside the body",
                                    "a node of its surface", "nothing can touch it; leave it out"});
            mark(node);
        }
    } else {
        const PredicateOf predicate_of{mesh, boundary, rule.text};
        const Predicate picks = std::visit(predicate_of, rule.pick);
        for (const std::int32_t node : boundary.nodes)
            if (picks(node)) mark(node);
    }
    if (!any)
        throw InvalidInput({rule.text, "picks no node", "1 or more",
                            "check it against the mesh in ParaView; positions are LPS mm"});
}

std::vector<std::int32_t> nodes_of(const TetMesh& mesh, const BoundarySurface& boundary,
                                   std::span<const NodeRule> rules, Reach reach) {
    std::vector<bool> marked(mesh.rest_positions.size(), false);
    for (const NodeRule& rule : rules) mark_nodes(mesh, boundary, rule, reach, marked);
    std::vector<std::int32_t> nodes;
    for (std::size_t node = 0; node < marked.size(); ++node)
        if (marked[node]) nodes.push_back(static_cast<std::int32_t>(node));
    return nodes;
}

std::vector<std::int32_t> without(const std::vector<std::int32_t>& nodes,
                                  std::span<const std::int32_t> others) {
    std::vector<std::int32_t> rest;
    std::ranges::set_difference(nodes, others, std::back_inserter(rest));
    return rest;
}

}  // namespace

NodeRule parse_node_rule(std::string_view option, std::string_view text) {
    const auto colon = text.find(':');
    const std::string_view kind = text.substr(0, colon);
    const std::string_view rest = colon == std::string_view::npos ? "" : text.substr(colon + 1);
    const std::string rule = std::string(option) + " " + std::string(text);
    if (kind == "touching" && !rest.empty()) return {rule, TouchingLabel{std::string(rest)}};
    if (kind == "region" && !rest.empty()) return {rule, OfRegion{std::string(rest)}};
    if (kind == "nodes" && !rest.empty()) return {rule, ListedNodes{rest}};
    if (kind == "box") return {rule, box_of(numbers_of(rest, box_meaning, rule), rule)};
    if (kind == "sphere") return {rule, sphere_of(numbers_of(rest, sphere_meaning, rule), rule)};
    if (kind == "plane") return {rule, plane_of(numbers_of(rest, plane_meaning, rule), rule)};
    if (kind == "facing") return {rule, facing_of(numbers_of(rest, facing_meaning, rule), rule)};
    throw UsageError({std::string(option) + " '" + std::string(text) + "'", "is no rule that picks nodes",
                      std::string(node_rule_grammar), ""});
}

NodeRule box_rule(std::string_view option, const std::vector<double>& corners) {
    const std::string rule = rule_text(option, "box", corners);
    return {rule, box_of(corners, rule)};
}

NodeRule sphere_rule(std::string_view option, const std::vector<double>& center_and_radius) {
    const std::string rule = rule_text(option, "sphere", center_and_radius);
    return {rule, sphere_of(center_and_radius, rule)};
}

NodeRule plane_rule(std::string_view option, const std::vector<double>& point_and_normal) {
    const std::string rule = rule_text(option, "plane", point_and_normal);
    return {rule, plane_of(point_and_normal, rule)};
}

NodeRule facing_rule(std::string_view option, const std::vector<double>& direction) {
    const std::string rule = rule_text(option, "facing", direction);
    return {rule, facing_of(direction, rule)};
}

std::vector<std::int32_t> fixed_nodes_of(const TetMesh& mesh, const BoundarySurface& boundary,
                                         std::span<const NodeRule> rules) {
    return nodes_of(mesh, boundary, rules, Reach::whole_mesh);
}

std::vector<std::int32_t> contact_nodes_of(const TetMesh& mesh, const BoundarySurface& boundary,
                                           std::span<const NodeRule> rules,
                                           std::span<const std::int32_t> fixed_nodes) {
    if (rules.empty()) return without(boundary.nodes, fixed_nodes);
    auto nodes = without(nodes_of(mesh, boundary, rules, Reach::surface), fixed_nodes);
    if (nodes.empty())
        throw InvalidInput({rules.front().text + (rules.size() > 1 ? " and the others" : ""),
                            "every node picked is fixed", "1 or more that can move",
                            "hold fewer nodes or choose another contact surface"});
    return nodes;
}

std::vector<std::int32_t> contact_surface_of(const DeformableBody& body) {
    auto nodes = without(body.boundary.nodes, body.fixed_nodes);
    if (nodes.empty())
        throw InvalidInput(
            {body.name, "every surface node is held, so nothing can be touched", "", "hold fewer nodes"});
    if (body.contact_nodes.empty()) return nodes;
    for (std::size_t i = 0; i < body.contact_nodes.size(); ++i) {
        const std::int32_t node = body.contact_nodes[i];
        if ((i > 0 && node <= body.contact_nodes[i - 1]) || !std::ranges::binary_search(nodes, node))
            throw InvalidInput(
                {body.name,
                 "entry " + std::to_string(i) + " of its contact nodes is node " + std::to_string(node),
                 "ascending surface nodes that are not fixed", "pick them with contact_nodes_of()"});
    }
    return body.contact_nodes;
}

}  // namespace palpate::fem
