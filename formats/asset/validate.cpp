// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/validate.hpp"

#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <iterator>
#include <span>
#include <utility>

#include "formats/model/closure.hpp"
#include "formats/model/disjoint_sets.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/reading/utf8.hpp"

namespace palpate::asset {
namespace {

[[noreturn]] void refuse(const std::string& where, const std::string& found,
                         const std::string& expected = "") {
    throw InvalidInput(
        {where, found, expected, "the file is damaged or its parts do not fit; make it again"});
}

template <std::size_t n>
void check_indices(const std::vector<std::array<std::int32_t, n>>& cells, std::size_t vertex_count,
                   const std::string& where) {
    for (std::size_t i = 0; i < cells.size(); ++i)
        for (const std::int32_t index : cells[i])
            if (index < 0 || static_cast<std::size_t>(index) >= vertex_count)
                refuse(where, "entry " + std::to_string(i) + " has index " + std::to_string(index),
                       "0 to " + std::to_string(vertex_count) + " exclusive");
}

void check_ascending(const std::vector<std::int32_t>& nodes, std::size_t node_count,
                     const std::string& where) {
    for (std::size_t i = 0; i < nodes.size(); ++i)
        if (nodes[i] < 0 || static_cast<std::size_t>(nodes[i]) >= node_count ||
            (i > 0 && nodes[i] <= nodes[i - 1]))
            refuse(where, "entry " + std::to_string(i) + " is " + std::to_string(nodes[i]),
                   "ascending node indices below " + std::to_string(node_count));
}

void check_points(const std::vector<Eigen::Vector3d>& points, const std::string& where) {
    for (std::size_t i = 0; i < points.size(); ++i)
        if (!(points[i].array().abs() <= farthest_coordinate).all())
            refuse(where, "point " + std::to_string(i) + " is not finite or far from any patient",
                   "coordinates up to " + std::to_string(static_cast<int>(farthest_coordinate)) + " mm");
}

void check_labels(const std::vector<Label>& labels, const std::string& where) {
    for (std::size_t i = 0; i < labels.size(); ++i) {
        check_name(labels[i].name, where);
        if (labels[i].value < 1 || labels[i].value > 65535 ||
            (i > 0 && labels[i].value <= labels[i - 1].value))
            refuse(where, "label value " + std::to_string(labels[i].value), "ascending values, 1 to 65535");
        for (const float channel : labels[i].colour)
            if (!(channel >= 0 && channel <= 1)) refuse(where, "a colour is out of range", "0 to 1");
    }
}

bool has_label(const std::vector<Label>& labels, std::int32_t value) {
    return std::ranges::binary_search(labels, value, {}, &Label::value);
}

void check_mesh(const TetMesh& mesh, const std::string& where) {
    check_points(mesh.rest_positions, where + "/rest_positions");
    if (mesh.tetrahedra.empty()) refuse(where + "/tetrahedra", "is empty");
    check_indices(mesh.tetrahedra, mesh.rest_positions.size(), where + "/tetrahedra");
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (!(six_volume(mesh, t) > 0))
            refuse(where + "/tetrahedra", "tetrahedron " + std::to_string(t) + " is flat or inside out");
    if (mesh.regions.size() != mesh.tetrahedra.size())
        refuse(where + "/regions", std::to_string(mesh.regions.size()) + " values",
               std::to_string(mesh.tetrahedra.size()));

    check_labels(mesh.region_names, where + "/region_names");
    std::vector<std::int32_t> occurring = mesh.regions;
    std::ranges::sort(occurring);
    occurring.erase(std::ranges::unique(occurring).begin(), occurring.end());
    if (!std::ranges::equal(occurring, mesh.region_names, {}, {}, &Label::value))
        refuse(where + "/region_names", "does not name exactly the values that occur in regions");

    check_labels(mesh.outside_names, where + "/outside_names");
    if (!mesh.outside_labels.empty() && mesh.outside_labels.size() != mesh.rest_positions.size())
        refuse(where + "/outside_labels", std::to_string(mesh.outside_labels.size()) + " values",
               "none or " + std::to_string(mesh.rest_positions.size()));
    for (const std::int32_t label : mesh.outside_labels)
        if (label != -1 && label != 0 && !has_label(mesh.outside_names, label))
            refuse(where + "/outside_labels", "value " + std::to_string(label) + " has no name");
}

void check_materials(const DeformableBody& body, const std::string& where) {
    if (!std::ranges::equal(body.materials, body.mesh.region_names, {}, &RegionMaterial::region,
                            &Label::value))
        refuse(where, "does not have one material for each region, ascending");
    for (const auto& [region, material] : body.materials)
        if (const auto error = first_error(material_fields, material))
            refuse(where, error->name + " of region " + std::to_string(region) + " " + error->found,
                   error->expected);
}

void check_relaxation(const DeformableBody& body, const std::string& where) {
    const std::size_t most = most_relaxation_terms * body.mesh.region_names.size();
    if (body.relaxation.size() > most)
        refuse(where, "has " + std::to_string(body.relaxation.size()) + " terms",
               std::to_string(most) + " at most");
    if (!std::ranges::is_sorted(body.relaxation, {}, &RegionRelaxation::region))
        refuse(where, "is not in the order of its regions");
    std::vector<RelaxationTerm> terms;  // of one region
    for (std::size_t i = 0; i < body.relaxation.size(); ++i) {
        const auto& [label, term] = body.relaxation[i];
        if (i == 0 || label != body.relaxation[i - 1].region) terms.clear();
        terms.push_back(term);
        const std::string region = " of region " + std::to_string(label) + " ";
        if (!has_label(body.mesh.region_names, label))
            refuse(where, "a term" + region + "that the mesh does not have");
        if (const auto error = relaxation_error(terms))
            refuse(where, error->name + region + error->found, error->expected);
    }
}

void check_region_colours(const DeformableBody& body, const std::string& where) {
    const std::vector<RegionColour>& colours = body.region_colours;
    for (std::size_t i = 0; i < colours.size(); ++i)
        if (!has_label(body.mesh.region_names, colours[i].region) ||
            (i > 0 && colours[i].region <= colours[i - 1].region))
            refuse(where, "has region " + std::to_string(colours[i].region),
                   "regions of the body, ascending");
}

// Whatever hangs together must be held; a node of nothing would be held by nothing.
void check_held(const DeformableBody& body, const std::string& where) {
    const std::size_t nodes = body.mesh.rest_positions.size();
    DisjointSets parts(nodes);
    std::vector<bool> used(nodes, false);
    for (const Tetrahedron& tet : body.mesh.tetrahedra)
        for (const std::int32_t node : tet) {
            used[static_cast<std::size_t>(node)] = true;
            parts.join(static_cast<std::size_t>(tet[0]), static_cast<std::size_t>(node));
        }
    std::vector<int> held(nodes, 0);
    for (const std::int32_t node : body.fixed_nodes) ++held[parts.root(static_cast<std::size_t>(node))];
    constexpr int enough = 3;  // nodes, if not in a line
    for (std::size_t node = 0; node < nodes; ++node) {
        if (!used[node])
            refuse(where + "/tetrahedra", "node " + std::to_string(node) + " belongs to none of them");
        if (held[parts.root(node)] < enough)
            refuse(where + "/fixed_nodes",
                   "the part of the body with node " + std::to_string(node) + " is not held",
                   "3 fixed nodes or more");
    }
}

void check_boundary(const DeformableBody& body, const std::string& where) {
    const BoundarySurface boundary = boundary_surface(body.mesh);
    if (body.boundary.nodes != boundary.nodes ||
        body.boundary.surface.triangles != boundary.surface.triangles ||
        body.boundary.surface.vertices != boundary.surface.vertices)
        refuse(where + "/surface_triangles", "is not the boundary of the tetrahedra");

    if (!faces_cancel(body.mesh, boundary))
        refuse(where + "/tetrahedra", "a face is of three tetrahedra or more, or of two on its one side");

    check_ascending(body.fixed_nodes, body.mesh.rest_positions.size(), where + "/fixed_nodes");
    if (body.fixed_nodes.empty()) refuse(where + "/fixed_nodes", "is empty", "nodes that hold the body");
    check_held(body, where);
    check_ascending(body.contact_nodes, body.mesh.rest_positions.size(), where + "/contact_nodes");
    for (const std::int32_t node : body.contact_nodes)
        if (!std::ranges::binary_search(boundary.nodes, node) ||
            std::ranges::binary_search(body.fixed_nodes, node))
            refuse(where + "/contact_nodes", "node " + std::to_string(node) + " is not free surface",
                   "boundary nodes that are not fixed");
}

// A float is finite unless all bits of its exponent are set; as integers, the test runs on whole vectors.
bool all_finite(std::span<const float> values) {
    constexpr std::uint32_t exponent = 0x7F800000U;
    std::uint32_t found = 0;
    for (const float value : values)
        found |= (std::bit_cast<std::uint32_t>(value) & exponent) == exponent ? 1U : 0U;
    return found == 0;
}

void check_dense(const DenseCompliance& compliance, const std::string& where) {
    const std::size_t dofs = compliance.dof_count();
    if (!all_finite({compliance.entries.get(), dofs * dofs}))
        refuse(where, "has an entry that is not finite");
    for (std::size_t dof = 0; dof < dofs; ++dof)
        if (!(compliance.row(dof)[dof] > 0))
            refuse(where, "diagonal entry " + std::to_string(dof) + " is not positive");
}

// Walks the tree of blocks: every block once, parts after their whole, sizes within the values.
class BlockWalk {
  public:
    BlockWalk(const HierarchicalCompliance& compliance, const std::string& where)
        : c_(compliance), where_(where), seen_(compliance.blocks.size(), false) {}

    void visit(std::size_t index, std::int32_t level, std::int32_t row, std::int32_t column) {
        if (index >= seen_.size() || seen_[index]) refuse(where_, "has blocks out of place");
        seen_[index] = true;
        const ComplianceBlock& block = c_.blocks[index];
        const std::string name = "block " + std::to_string(index);
        if (block.first_child != 0) {
            if (block.first_child <= static_cast<std::int64_t>(index) || level == c_.depth)
                refuse(where_, name + " has parts out of place");
            auto part = static_cast<std::size_t>(block.first_child);
            for (std::int32_t i = 0; i < 2; ++i)
                for (std::int32_t j = 0; j < (row == column ? i + 1 : 2); ++j)
                    visit(part++, level + 1, 2 * row + i, 2 * column + j);
            return;
        }
        const auto dofs = [&](std::int32_t cluster) {
            return 3 * std::int64_t{c_.begin(level, cluster + 1) - c_.begin(level, cluster)};
        };
        const bool dense = block.rank == ComplianceBlock::dense;
        if (!dense && (block.rank < 0 || block.rank > HierarchicalCompliance::max_rank ||
                       block.rank % 4 != 0 || row == column))
            refuse(where_, name + " has rank " + std::to_string(block.rank));
        require_within(dense ? dofs(row) * dofs(column) : block.rank, block.values, c_.value_count, name);
        if (!dense)
            require_within((dofs(row) + dofs(column)) * block.rank, block.factors, c_.factor_count, name);
        if (dense && row == column)
            for (std::int64_t d = 0; d < dofs(row); ++d)
                if (!(c_.values.get()[block.values + d * (dofs(row) + 1)] > 0))
                    refuse(where_, "diagonal entry of " + name + " is not positive");
    }
    void require_within(std::int64_t size, std::int64_t offset, std::size_t count,
                        const std::string& name) const {
        if (offset < 0 || size > static_cast<std::int64_t>(count) - offset)
            refuse(where_, name + " lies outside the values");
    }
    bool all_seen() const { return std::ranges::find(seen_, false) == seen_.end(); }

  private:
    const HierarchicalCompliance& c_;
    const std::string& where_;
    std::vector<bool> seen_;
};

void check_compliance(const DeformableBody& body, const std::string& where) {
    if (node_count(body.compliance) < 1 ||
        static_cast<std::size_t>(node_count(body.compliance)) != body.contact_nodes.size())
        refuse(where, "has " + std::to_string(node_count(body.compliance)) + " nodes",
               std::to_string(body.contact_nodes.size()) + " contact nodes, at least one");
    if (const auto* dense = std::get_if<DenseCompliance>(&body.compliance))
        check_dense(*dense, where);
    else
        check_hierarchical(std::get<HierarchicalCompliance>(body.compliance), where);
}

void check_certificate(const Certificate& certificate, const std::string& where) {
    if (const auto error = first_error(certificate_fields, certificate))
        refuse(where, error->name + " " + error->found, error->expected);
}

void check_box(const ObbNode& node, std::size_t index, const std::string& where) {
    constexpr float tolerance = 1e-4F;  // far above float32 round-off, far below what a query would notice
    const bool orthonormal =
        ((node.axes * node.axes.transpose() - Eigen::Matrix3f::Identity()).array().abs() < tolerance).all();
    if (!orthonormal || !node.center.allFinite() || !node.half_extents.allFinite() ||
        (node.half_extents.array() < 0).any())
        refuse(where, "box " + std::to_string(index) + " is not an oriented box");
}

}  // namespace

void check_name(const std::string& name, const std::string& where) {
    constexpr std::size_t longest = 255;
    if (name.empty() || name.size() > longest || !is_printable(name))
        refuse(where, "has a name that is empty, long or not printable",
               "1 to 255 bytes of UTF-8 without control characters");
}

void check_hierarchical(const HierarchicalCompliance& compliance, const std::string& where) {
    const auto nodes = static_cast<std::size_t>(compliance.node_count);
    if (compliance.depth < 0 || compliance.depth > HierarchicalCompliance::deepest ||
        (std::int64_t{1} << compliance.depth) > std::max<std::int64_t>(1, compliance.node_count))
        refuse(where, "has depth " + std::to_string(compliance.depth));
    if (!(compliance.accuracy > 0 && compliance.accuracy <= HierarchicalCompliance::coarsest_accuracy))
        refuse(where, "has an accuracy of " + std::to_string(compliance.accuracy), "above 0, 0.1 at most");
    std::vector<char> seen(nodes, 0);
    if (compliance.order.size() != nodes) refuse(where + "/order", "has another length than contact_nodes");
    for (const std::int32_t node : compliance.order)
        if (node < 0 || static_cast<std::size_t>(node) >= nodes || std::exchange(seen[node], 1) != 0)
            refuse(where + "/order", "is not a permutation of the contact nodes");
    if (!all_finite({compliance.values.get(), compliance.value_count}))
        refuse(where + "/values", "has an entry that is not finite");
    BlockWalk walk(compliance, where);
    walk.visit(0, 0, 0, 0);
    if (!walk.all_seen()) refuse(where, "has blocks that belong to nothing");
}

void check_feel(const Feel& feel, const DeformableBody& body, const std::string& where) {
    for (const double length : {feel.tool_radius, feel.depth})
        if (!(length > 0 && std::isfinite(length)))
            refuse(where, "has a tool_radius or depth of " + std::to_string(length), "a positive number");
    if (feel.stiffness.size() != body.boundary.nodes.size())
        refuse(where + "/stiffness", std::to_string(feel.stiffness.size()) + " values",
               std::to_string(body.boundary.nodes.size()));
    for (std::size_t v = 0; v < feel.stiffness.size(); ++v) {
        const bool touched = std::ranges::binary_search(body.contact_nodes, body.boundary.nodes[v]);
        if (!std::isfinite(feel.stiffness[v]) || feel.stiffness[v] < 0 ||
            (!touched && feel.stiffness[v] != 0))
            refuse(where + "/stiffness",
                   "entry " + std::to_string(v) + " is " + std::to_string(feel.stiffness[v]),
                   touched ? "0 or more" : "0 where there is no contact node");
    }
    for (std::size_t i = 0; i < feel.regions.size(); ++i) {
        const FeltRegion& felt = feel.regions[i];
        const std::string region = where + "/regions/" + std::to_string(i);
        if (const auto error = first_error(felt_region_fields, felt))
            refuse(region, error->name + " " + error->found, error->expected);
        if (!has_label(body.mesh.region_names, felt.region) ||
            (i > 0 && felt.region <= feel.regions[i - 1].region))
            refuse(region, "is of region " + std::to_string(felt.region), "regions of the body, ascending");
        if (static_cast<std::size_t>(felt.vertex) >= feel.stiffness.size() ||
            static_cast<float>(felt.stiffness) != feel.stiffness[felt.vertex])
            refuse(region, "has another stiffness than its vertex");
    }
}

void check_haptics(const HapticSettings& haptics, const std::string& where) {
    if (const auto error = haptics_error(haptics))
        refuse(where, error->name + " " + error->found, error->expected);
}

void check_surface(const TriangleMesh& surface, const std::string& where) {
    check_points(surface.vertices, where + "/vertices");
    if (surface.triangles.empty()) refuse(where + "/triangles", "is empty");
    check_indices(surface.triangles, surface.vertices.size(), where + "/triangles");
}

void check_sides(const TriangleMesh& surface, const std::string& where) {
    if (!edges_cancel(surface)) refuse(where + "/triangles", "are not a closed surface of two sides");
    if (!(enclosed_volume(surface) > 0)) refuse(where + "/triangles", "face inwards or hold no volume");
}

void check_obb_tree(const ObbTree& tree, std::size_t triangle_count, const std::string& where) {
    if (tree.nodes.empty()) refuse(where, "has no nodes");
    if (tree.triangle_order.size() != triangle_count)
        refuse(where + "/triangle_order", std::to_string(tree.triangle_order.size()) + " entries",
               std::to_string(triangle_count));
    std::vector<char> seen(triangle_count);
    for (const std::int32_t triangle : tree.triangle_order) {
        if (triangle < 0 || static_cast<std::size_t>(triangle) >= triangle_count ||
            std::exchange(seen[triangle], 1) != 0)
            refuse(where + "/triangle_order", "is not a permutation of the triangles");
    }

    constexpr int unreached = -1;
    std::vector<int> depth(tree.nodes.size(), unreached);
    depth[0] = 0;
    std::ranges::fill(seen, 0);  // now: entries of triangle_order that a leaf holds
    std::size_t held = 0;
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const ObbNode& node = tree.nodes[i];
        check_box(node, i, where);
        const std::string box = "box " + std::to_string(i);
        if (depth[i] == unreached) refuse(where, box + " has no parent before it");
        if (depth[i] > deepest_obb_tree)
            refuse(where, "is too deep", std::to_string(deepest_obb_tree) + " levels");
        if (node.first < 0 || node.count < 0) refuse(where, box + " has a negative range");
        const auto first = static_cast<std::size_t>(node.first);
        if (node.count == 0) {
            if (first <= i || first + 1 >= tree.nodes.size() || depth[first] != unreached ||
                depth[first + 1] != unreached)
                refuse(where, box + " has children out of place");
            depth[first] = depth[first + 1] = depth[i] + 1;
            continue;
        }
        const auto count = static_cast<std::size_t>(node.count);
        if (node.count > most_leaf_triangles)
            refuse(where, box + " holds " + std::to_string(node.count) + " triangles",
                   std::to_string(most_leaf_triangles) + " at most");
        if (first + count > triangle_count) refuse(where, box + " has triangles beyond the last");
        for (std::size_t entry = first; entry < first + count; ++entry)
            if (std::exchange(seen[entry], 1) != 0)
                refuse(where, box + " shares a triangle with another leaf");
        held += count;
    }
    if (held != triangle_count) refuse(where, "leaves out triangles");
}

void check_enclosure(const ObbTree& tree, const TriangleMesh& surface, const std::string& where) {
    std::vector<std::int32_t> parent(tree.nodes.size(), -1);
    for (std::size_t i = 0; i < tree.nodes.size(); ++i)
        if (tree.nodes[i].count == 0) {
            const auto child = static_cast<std::size_t>(tree.nodes[i].first);
            parent[child] = parent[child + 1] = static_cast<std::int32_t>(i);
        }
    // How far the triangles reach along each box's axes.
    std::vector<Eigen::Vector3d> reach(tree.nodes.size(), Eigen::Vector3d::Zero());
    const auto check_box_around = [&](std::int32_t index, std::span<const std::int32_t> vertices) {
        const ObbNode& box = tree.nodes[static_cast<std::size_t>(index)];
        const Eigen::Matrix3d axes = box.axes.cast<double>();
        const Eigen::Vector3d center = box.center.cast<double>(), half = box.half_extents.cast<double>();
        Eigen::Vector3d& farthest = reach[static_cast<std::size_t>(index)];
        for (const std::int32_t v : vertices)
            farthest = farthest.cwiseMax((axes * (surface.vertices[v] - center)).cwiseAbs());
        const double escape = (farthest - half).maxCoeff();
        if (escape > farthest_escape)
            refuse(where,
                   "box " + std::to_string(index) + " leaves a triangle " + std::to_string(escape) +
                       " mm outside",
                   "boxes that enclose their triangles");
    };
    const std::span<const std::int32_t> order = tree.triangle_order;
    std::vector<std::int32_t> vertices;  // of a leaf, each once: a triangle's are its neighbours' too
    for (std::size_t leaf = 0; leaf < tree.nodes.size(); ++leaf) {
        const ObbNode& node = tree.nodes[leaf];
        if (node.count == 0) continue;
        vertices.clear();
        for (const std::int32_t t :
             order.subspan(static_cast<std::size_t>(node.first), static_cast<std::size_t>(node.count)))
            vertices.insert(vertices.end(), surface.triangles[t].begin(), surface.triangles[t].end());
        std::ranges::sort(vertices);
        vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
        for (auto i = static_cast<std::int32_t>(leaf); i >= 0; i = parent[i]) check_box_around(i, vertices);
    }
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const double slack = (tree.nodes[i].half_extents.cast<double>() - reach[i]).maxCoeff();
        if (slack > farthest_slack)
            refuse(where, "box " + std::to_string(i) + " is " + std::to_string(slack) + " mm too large",
                   "boxes that fit their triangles");
    }
}

void check_body(const DeformableBody& body, const std::string& where) {
    check_name(body.name, where);
    check_mesh(body.mesh, where);
    check_materials(body, where + "/materials");
    check_relaxation(body, where + "/relaxation");
    check_region_colours(body, where + "/drawn_regions");
    check_boundary(body, where);
    check_compliance(body, where + "/compliance");
    check_certificate(body.certificate, where + "/certificate");
}

}  // namespace palpate::asset
