// SPDX-License-Identifier: Apache-2.0
#include "tests/formats/sample_case.hpp"

#include <Eigen/Geometry>
#include <Eigen/SVD>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <map>
#include <memory>
#include <numeric>
#include <span>
#include <utility>
#include <variant>

namespace palpate::sample {
namespace {

Eigen::Vector3d centroid(const TriangleMesh& surface, std::int32_t triangle) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::int32_t v : surface.triangles[static_cast<std::size_t>(triangle)])
        sum += surface.vertices[static_cast<std::size_t>(v)];
    return sum / 3;
}

ObbNode box_around(const TriangleMesh& surface, const std::vector<std::int32_t>& order, std::size_t first,
                   std::size_t count) {
    Eigen::AlignedBox3d box;
    for (std::size_t i = first; i < first + count; ++i)
        for (const std::int32_t v : surface.triangles[static_cast<std::size_t>(order[i])])
            box.extend(surface.vertices[static_cast<std::size_t>(v)]);
    const double padding = 1e-4;  // mm: above float32 round-off of coordinates below 1 m
    return {.axes = Eigen::Matrix3f::Identity(),
            .center = box.center().cast<float>(),
            .half_extents = (box.sizes() / 2 + Eigen::Vector3d::Constant(padding)).cast<float>(),
            .first = static_cast<std::int32_t>(first),
            .count = static_cast<std::int32_t>(count)};
}

// The rows of one cluster and the columns of another, in the order of the clusters' positions.
Eigen::MatrixXd coupling(const DenseCompliance& dense, std::span<const std::int32_t> rows,
                         std::span<const std::int32_t> columns) {
    Eigen::MatrixXd block(3 * rows.size(), 3 * columns.size());
    for (std::size_t i = 0; i < 3 * rows.size(); ++i)
        for (std::size_t j = 0; j < 3 * columns.size(); ++j)
            block(static_cast<Eigen::Index>(i), static_cast<Eigen::Index>(j)) =
                static_cast<double>(dense.row(3 * static_cast<std::size_t>(rows[i / 3]) +
                                              i % 3)[3 * static_cast<std::size_t>(columns[j / 3]) + j % 3]);
    return block;
}

// Appends the leading columns row by row, each scaled to the range of 16 bits; returns the units, and appends
// zeros for columns that the matrix does not have.
Eigen::VectorXd append_factor(const Eigen::MatrixXd& columns, Eigen::Index kept, Eigen::Index rank,
                              std::vector<std::int16_t>& factors) {
    constexpr double largest = 32767;
    Eigen::VectorXd units = Eigen::VectorXd::Zero(rank);
    if (kept > 0) units.head(kept) = columns.leftCols(kept).cwiseAbs().colwise().maxCoeff() / largest;
    for (Eigen::Index row = 0; row < columns.rows(); ++row)
        for (Eigen::Index k = 0; k < rank; ++k)
            factors.push_back(k < kept ? static_cast<std::int16_t>(std::lround(columns(row, k) / units[k]))
                                       : std::int16_t{0});
    return units;
}

template <typename T>
std::shared_ptr<const T> kept_alive(std::vector<T> values) {
    const auto owner = std::make_shared<std::vector<T>>(std::move(values));
    return {owner, owner->data()};
}

}  // namespace

TetMesh cube_mesh(int cells, double edge) {
    TetMesh mesh;
    const int n = cells + 1;
    for (int k = 0; k < n; ++k)
        for (int j = 0; j < n; ++j)
            for (int i = 0; i < n; ++i)
                mesh.rest_positions.push_back(edge / cells * Eigen::Vector3d(i, j, k));
    const auto node = [&](const Eigen::Vector3i& c) { return c.x() + n * (c.y() + n * c.z()); };
    // Kuhn's six tetrahedra: one path along the axes from corner 000 to 111 for each order of the axes.
    constexpr std::array<std::array<int, 3>, 6> paths{
        {{0, 1, 2}, {1, 2, 0}, {2, 0, 1}, {0, 2, 1}, {2, 1, 0}, {1, 0, 2}}};
    const Eigen::Vector3d middle = Eigen::Vector3d::Constant(edge / 2);
    for (int k = 0; k < cells; ++k)
        for (int j = 0; j < cells; ++j)
            for (int i = 0; i < cells; ++i)
                for (std::size_t p = 0; p < paths.size(); ++p) {
                    Eigen::Vector3i corner(i, j, k);
                    Tetrahedron tet{node(corner), 0, 0, 0};
                    for (std::size_t step = 0; step < 3; ++step) {
                        ++corner[paths[p][step]];
                        tet[step + 1] = node(corner);
                    }
                    if (p >= 3) std::swap(tet[1], tet[2]);  // odd orders of the axes are mirrored
                    Eigen::Vector3d center = Eigen::Vector3d::Zero();
                    for (const std::int32_t v : tet)
                        center += mesh.rest_positions[static_cast<std::size_t>(v)] / 4;
                    mesh.tetrahedra.push_back(tet);
                    mesh.regions.push_back((center - middle).norm() < edge / 4 ? 2 : 1);
                }
    mesh.region_names = {{.value = 1, .name = "tissue", .colour = default_label_colour(1)}};
    if (std::ranges::count(mesh.regions, 2) > 0)
        mesh.region_names.push_back({.value = 2, .name = "tumour", .colour = default_label_colour(2)});
    return mesh;
}

TriangleMesh sphere_surface(const Eigen::Vector3d& center, double radius, int levels) {
    TriangleMesh mesh;
    mesh.vertices = {{1, 0, 0}, {-1, 0, 0}, {0, 1, 0}, {0, -1, 0}, {0, 0, 1}, {0, 0, -1}};
    mesh.triangles = {{0, 2, 4}, {2, 1, 4}, {1, 3, 4}, {3, 0, 4}, {2, 0, 5}, {1, 2, 5}, {3, 1, 5}, {0, 3, 5}};
    for (int level = 0; level < levels; ++level) {
        std::map<std::pair<std::int32_t, std::int32_t>, std::int32_t> middles;
        const auto middle = [&](std::int32_t a, std::int32_t b) {
            const auto [entry, added] =
                middles.try_emplace(std::minmax(a, b), static_cast<std::int32_t>(mesh.vertices.size()));
            if (added)
                mesh.vertices.push_back(
                    (mesh.vertices[static_cast<std::size_t>(a)] + mesh.vertices[static_cast<std::size_t>(b)])
                        .normalized());
            return entry->second;
        };
        std::vector<Triangle> finer;
        for (const auto [a, b, c] : mesh.triangles) {
            const std::int32_t ab = middle(a, b), bc = middle(b, c), ca = middle(c, a);
            finer.insert(finer.end(), {{a, ab, ca}, {b, bc, ab}, {c, ca, bc}, {ab, bc, ca}});
        }
        mesh.triangles = std::move(finer);
    }
    for (Eigen::Vector3d& vertex : mesh.vertices) vertex = center + radius * vertex;
    return mesh;
}

ObbTree median_tree(const TriangleMesh& surface, std::size_t leaf_size) {
    ObbTree tree;
    tree.triangle_order.resize(surface.triangles.size());
    std::iota(tree.triangle_order.begin(), tree.triangle_order.end(), 0);
    tree.nodes.push_back(box_around(surface, tree.triangle_order, 0, tree.triangle_order.size()));
    for (std::size_t i = 0; i < tree.nodes.size(); ++i) {
        const auto first = static_cast<std::size_t>(tree.nodes[i].first);
        const auto count = static_cast<std::size_t>(tree.nodes[i].count);
        if (count <= leaf_size) continue;
        Eigen::Index axis = 0;
        tree.nodes[i].half_extents.maxCoeff(&axis);
        const auto begin = std::next(tree.triangle_order.begin(), static_cast<std::ptrdiff_t>(first));
        std::nth_element(
            begin, std::next(begin, static_cast<std::ptrdiff_t>(count / 2)),
            std::next(begin, static_cast<std::ptrdiff_t>(count)), [&](std::int32_t a, std::int32_t b) {
                const double left = centroid(surface, a)[axis], right = centroid(surface, b)[axis];
                return left < right || (left == right && a < b);
            });
        tree.nodes[i].first = static_cast<std::int32_t>(tree.nodes.size());
        tree.nodes[i].count = 0;
        tree.nodes.push_back(box_around(surface, tree.triangle_order, first, count / 2));
        tree.nodes.push_back(box_around(surface, tree.triangle_order, first + count / 2, count - count / 2));
    }
    return tree;
}

DenseCompliance kernel_compliance(const TetMesh& mesh, const std::vector<std::int32_t>& nodes, double length,
                                  double scale) {
    DenseCompliance compliance;
    compliance.node_count = static_cast<std::int32_t>(nodes.size());
    const std::size_t dofs = compliance.dof_count();
    const std::shared_ptr<float[]> entries(new float[dofs * dofs]());
    for (std::size_t a = 0; a < nodes.size(); ++a)
        for (std::size_t b = 0; b < nodes.size(); ++b) {
            const double distance = (mesh.rest_positions[static_cast<std::size_t>(nodes[a])] -
                                     mesh.rest_positions[static_cast<std::size_t>(nodes[b])])
                                        .norm();
            for (std::size_t axis = 0; axis < 3; ++axis)
                entries[(3 * a + axis) * dofs + 3 * b + axis] =
                    static_cast<float>(scale * std::exp(-distance / length));
        }
    compliance.entries = std::shared_ptr<const float>(entries, entries.get());
    return compliance;
}

HierarchicalCompliance hierarchical(const DenseCompliance& dense, std::vector<std::int32_t> order, int depth,
                                    double accuracy) {
    HierarchicalCompliance c;
    c.node_count = dense.node_count;
    c.depth = depth;
    c.accuracy = accuracy;
    c.positions.resize(order.size());
    for (std::size_t p = 0; p < order.size(); ++p)
        c.positions[static_cast<std::size_t>(order[p])] = static_cast<std::int32_t>(p);
    c.order = std::move(order);
    const std::size_t entries = dense.dof_count() * dense.dof_count();
    double largest = 0;
    for (const float entry : std::span(dense.entries.get(), entries))
        largest = std::max(largest, std::abs(static_cast<double>(entry)));

    struct Clusters {
        std::int32_t level, row, column;
    };
    std::vector<Clusters> clusters{{0, 0, 0}};
    std::vector<float> values;
    std::vector<std::int16_t> factors;
    for (std::size_t b = 0; b < clusters.size(); ++b) {
        const auto [level, row, column] = clusters[b];
        ComplianceBlock& block = c.blocks.emplace_back();
        if (row - column <= 1 && level < depth) {
            block.first_child = static_cast<std::int32_t>(clusters.size());
            for (std::int32_t i = 0; i < 2; ++i)
                for (std::int32_t j = 0; j < (row == column ? i + 1 : 2); ++j)
                    clusters.push_back({level + 1, 2 * row + i, 2 * column + j});
            continue;
        }
        const auto positions = [&](std::int32_t cluster) {
            const auto first = static_cast<std::size_t>(c.begin(level, cluster));
            return std::span<const std::int32_t>(c.order).subspan(
                first, static_cast<std::size_t>(c.begin(level, cluster + 1)) - first);
        };
        const Eigen::MatrixXd matrix = coupling(dense, positions(row), positions(column));
        block.values = static_cast<std::int64_t>(values.size());
        block.factors = static_cast<std::int64_t>(factors.size());
        if (row - column <= 1) {
            for (Eigen::Index i = 0; i < matrix.rows(); ++i)
                for (Eigen::Index j = 0; j < matrix.cols(); ++j)
                    values.push_back(static_cast<float>(matrix(i, j)));
            continue;
        }
        const Eigen::JacobiSVD<Eigen::MatrixXd> svd(matrix, Eigen::ComputeThinU | Eigen::ComputeThinV);
        const Eigen::VectorXd& singular = svd.singularValues();
        const Eigen::Index kept = (singular.array() > accuracy * largest).count(), rank = (kept + 3) / 4 * 4;
        block.rank = static_cast<std::int32_t>(rank);
        const Eigen::VectorXd u = append_factor(svd.matrixU(), kept, rank, factors);
        const Eigen::VectorXd v = append_factor(svd.matrixV(), kept, rank, factors);
        for (Eigen::Index k = 0; k < rank; ++k)
            values.push_back(k < kept ? static_cast<float>(singular[k] * u[k] * v[k]) : 0.0F);
    }
    c.value_count = values.size();
    c.values = kept_alive(std::move(values));
    c.factor_count = factors.size();
    c.factors = kept_alive(std::move(factors));
    return c;
}

DeformableBody with_hierarchical_compliance(DeformableBody body, int depth, double accuracy) {
    std::vector<std::int32_t> order(body.contact_nodes.size());
    std::iota(order.begin(), order.end(), 0);
    const auto position = [&](std::int32_t contact_node) {
        const Eigen::Vector3d& p = body.mesh.rest_positions[static_cast<std::size_t>(
            body.contact_nodes[static_cast<std::size_t>(contact_node)])];
        return std::array{p.x(), p.y(), p.z()};
    };
    std::ranges::sort(order, {}, position);
    body.compliance =
        hierarchical(std::get<DenseCompliance>(body.compliance), std::move(order), depth, accuracy);
    return body;
}

DeformableBody elastic_cube(int cells) {
    const double edge = 20;
    DeformableBody body;
    body.name = "wall";
    body.mesh = cube_mesh(cells, edge);
    for (const Label& region : body.mesh.region_names)
        body.materials.push_back({region.value, {region.value == 1 ? 5e-3 : 40e-3, 0.45}});
    body.boundary = boundary_surface(body.mesh);
    body.mesh.outside_labels.assign(body.mesh.rest_positions.size(), -1);
    body.mesh.outside_names = {{.value = 7, .name = "bone", .colour = default_label_colour(7)}};
    for (const std::int32_t node : body.boundary.nodes) {
        const bool held = body.mesh.rest_positions[static_cast<std::size_t>(node)].z() == 0;
        body.mesh.outside_labels[static_cast<std::size_t>(node)] = held ? 7 : 0;
        (held ? body.fixed_nodes : body.contact_nodes).push_back(node);
    }
    body.compliance = kernel_compliance(body.mesh, body.contact_nodes, edge / 4, 1.0);
    body.certificate = {.residual = 3e-8,
                        .residual_double = 2e-13,
                        .asymmetry = 0,
                        .smallest_eigenvalue = 0.1,
                        .largest_eigenvalue = 12,
                        .condition_number = 120,
                        .reciprocity = 1e-7,
                        .sampled_columns = 16,
                        .load_error = 3e-7,
                        .contact_error = 2e-7,
                        .sampled_loads = 32,
                        .smallest_patch_eigenvalue = 0.2,
                        .discretisation_error = 0.05,
                        .checked_strain = 0.25,
                        .checked_depth = 3.5,
                        .linear_force_error = 0.06,
                        .linear_surface_error = 0.1,
                        .free_dofs = static_cast<std::int64_t>(
                            3 * (body.mesh.rest_positions.size() - body.fixed_nodes.size()))};
    body.obb_tree = median_tree(body.boundary.surface, 4);
    return body;
}

Feel made_up_feel(const DeformableBody& body, double tool_radius) {
    Feel feel{.tool_radius = tool_radius, .depth = 4, .stiffness = {}, .regions = {}};
    for (const std::int32_t node : body.boundary.nodes) {
        const bool touched = std::ranges::binary_search(body.contact_nodes, node);
        feel.stiffness.push_back(touched ? 0.05F + 0.001F * static_cast<float>(node % 10) : 0.0F);
    }
    const auto vertex = std::ranges::find_if(feel.stiffness, [](float k) { return k > 0; });
    if (body.mesh.region_names.size() > 1)
        feel.regions = {{.region = body.mesh.region_names[1].value,
                         .vertex = static_cast<std::int32_t>(vertex - feel.stiffness.begin()),
                         .depth = 4.5,
                         .stiffness = static_cast<double>(*vertex),
                         .stiffness_without = static_cast<double>(*vertex) / 1.5,
                         .variation = 0.25}};
    return feel;
}

Scan made_up_scan() {
    Scan scan;
    scan.grid = {.size = {16, 9, 8},
                 .spacing = {5, 4, 3.5},
                 .origin = {-10, -8, -5},
                 .direction = Eigen::AngleAxisd(0.1, Eigen::Vector3d(1, 2, 3).normalized()).matrix()};
    scan.hounsfield = true;
    for (int k = 0; k < scan.grid.size[2]; ++k)
        for (int j = 0; j < scan.grid.size[1]; ++j)
            for (int i = 0; i < scan.grid.size[0]; ++i)
                scan.values.push_back(static_cast<std::int16_t>(40 * i + 20 * j + 10 * k - 300));
    return scan;
}

Case sample_case(int cells) {
    Case patient_case;
    patient_case.name = "sample";
    RigidBody skull;
    skull.name = "skull";
    skull.surface = sphere_surface({40, 10, 10}, 15, 3);
    skull.obb_tree = median_tree(skull.surface, 4);
    patient_case.rigid_bodies.push_back(std::move(skull));
    patient_case.deformable_bodies.push_back(elastic_cube(cells));
    patient_case.haptics = {
        .tool_radius = 1.5, .coupling_stiffness = 0.4, .max_force = 3.0, .max_force_rate = 0.25};
    DeformableBody& wall = patient_case.deformable_bodies.front();
    wall.feel = made_up_feel(wall, patient_case.haptics.tool_radius);
    patient_case.rigid_bodies.front().colour = Colour{226, 211, 180};
    wall.colour = Colour{204, 118, 108};
    wall.region_colours = {{.region = 1, .colour = {190, 100, 90}}};
    patient_case.scan = made_up_scan();
    patient_case.provenance = R"({"palpate":"0.1.0"})";
    return patient_case;
}

}  // namespace palpate::sample
