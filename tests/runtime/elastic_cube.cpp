// SPDX-License-Identifier: Apache-2.0
#include "tests/runtime/elastic_cube.hpp"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <span>
#include <utility>
#include <vector>

#include "tests/formats/sample_case.hpp"

namespace palpate::sample {

Material soft_tissue() {
    return {.youngs_modulus = 5e-3, .poissons_ratio = 0.45};
}

Eigen::MatrixXd dense_stiffness(const TetMesh& mesh, const Material& material) {
    const double E = material.youngs_modulus, nu = material.poissons_ratio;
    const double lambda = E * nu / ((1 + nu) * (1 - 2 * nu)), mu = E / (2 * (1 + nu));
    const auto dofs = static_cast<Eigen::Index>(3 * mesh.rest_positions.size());
    Eigen::MatrixXd K = Eigen::MatrixXd::Zero(dofs, dofs);
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        // Rows of the inverse of [1 x y z] give the gradients of the four shape functions.
        Eigen::Matrix4d corners;
        for (Eigen::Index c = 0; c < 4; ++c)
            corners.row(c) << 1,
                mesh.rest_positions[static_cast<std::size_t>(mesh.tetrahedra[t][static_cast<std::size_t>(c)])]
                    .transpose();
        const Eigen::Matrix4d shape = corners.inverse();
        const double volume = six_volume(mesh, t) / 6;
        for (Eigen::Index a = 0; a < 4; ++a)
            for (Eigen::Index b = 0; b < 4; ++b) {
                const Eigen::Vector3d g = shape.col(a).tail<3>(), h = shape.col(b).tail<3>();
                const Eigen::Matrix3d block = volume * (lambda * g * h.transpose() + mu * h * g.transpose() +
                                                        mu * g.dot(h) * Eigen::Matrix3d::Identity());
                K.block<3, 3>(3 * mesh.tetrahedra[t][static_cast<std::size_t>(a)],
                              3 * mesh.tetrahedra[t][static_cast<std::size_t>(b)]) += block;
            }
    }
    return K;
}

namespace {

// Some columns of the inverse of a symmetric positive definite matrix. Blocks of its bandwidth make it block
// tridiagonal, which a cube's stiffness is long before it is full: an order of magnitude less than by LLᵀ of
// the whole.
Eigen::MatrixXd columns_of_inverse(const Eigen::MatrixXd& matrix, std::span<const Eigen::Index> columns) {
    using Eigen::Index, Eigen::MatrixXd;
    const Index size = matrix.rows();
    Index width = 1;
    for (Index column = 0; column < size; ++column)
        for (Index row = size - 1; row >= column + width; --row)
            if (matrix(row, column) != 0) width = row - column + 1;
    std::vector<Eigen::LLT<MatrixXd>> diagonal;
    std::vector<MatrixXd> below;  // of L: rows of the next block, columns of this one
    for (Index first = 0; first < size; first += width) {
        const Index count = std::min(width, size - first), next = std::min(width, size - first - count);
        MatrixXd block = matrix.block(first, first, count, count);
        if (first > 0) block -= below.back() * below.back().transpose();
        diagonal.emplace_back(block);
        if (next == 0) break;
        MatrixXd coupling = matrix.block(first, first + count, count, next);
        diagonal.back().matrixL().solveInPlace(coupling);
        below.emplace_back(coupling.transpose());
    }
    MatrixXd x = MatrixXd::Zero(size, static_cast<Index>(columns.size()));
    for (std::size_t j = 0; j < columns.size(); ++j) x(columns[j], static_cast<Index>(j)) = 1;
    const auto rows = [&](std::size_t k) {
        return x.middleRows(width * static_cast<Index>(k), diagonal[k].rows());
    };
    for (std::size_t k = 0; k < diagonal.size(); ++k) {
        if (k > 0) rows(k) -= below[k - 1] * rows(k - 1);
        diagonal[k].matrixL().solveInPlace(rows(k));
    }
    for (std::size_t k = diagonal.size(); k-- > 0;) {
        if (k + 1 < diagonal.size()) rows(k) -= below[k].transpose() * rows(k + 1);
        diagonal[k].matrixU().solveInPlace(rows(k));
    }
    return x;
}

// Its compliance anew, of soft tissue.
DeformableBody with_true_compliance(DeformableBody body) {
    for (RegionMaterial& region : body.materials) region.material = soft_tissue();
    Eigen::MatrixXd K = dense_stiffness(body.mesh, soft_tissue());
    for (const std::int32_t node : body.fixed_nodes)
        for (Eigen::Index dof = 3 * node; dof < 3 * node + 3; ++dof) {
            K.row(dof).setZero();
            K.col(dof).setZero();
            K(dof, dof) = 1;
        }
    auto& compliance = std::get<DenseCompliance>(body.compliance);
    const std::size_t dofs = compliance.dof_count();
    const std::shared_ptr<float[]> entries(new float[dofs * dofs]);
    std::vector<Eigen::Index> mesh_dofs;
    for (const std::int32_t node : body.contact_nodes)
        for (Eigen::Index axis = 0; axis < 3; ++axis) mesh_dofs.push_back(3 * node + axis);
    const Eigen::MatrixXd inverse = columns_of_inverse(K, mesh_dofs);
    for (std::size_t i = 0; i < dofs; ++i)
        for (std::size_t j = 0; j <= i; ++j)
            entries[i * dofs + j] = entries[j * dofs + i] =
                static_cast<float>(inverse(mesh_dofs[j], static_cast<Eigen::Index>(i)));
    compliance.entries = std::shared_ptr<const float>(entries, entries.get());
    return body;
}

}  // namespace

DeformableBody true_elastic_cube(int cells) {
    return with_true_compliance(elastic_cube(cells));
}

DeformableBody true_elastic_cubes(int cells, const Eigen::Vector3d& offset) {
    const DeformableBody one = elastic_cube(cells);
    const auto nodes = static_cast<std::int32_t>(one.mesh.rest_positions.size());
    DeformableBody both = one;
    for (const Eigen::Vector3d& p : one.mesh.rest_positions) both.mesh.rest_positions.push_back(p + offset);
    for (const auto& [a, b, c, d] : one.mesh.tetrahedra)
        both.mesh.tetrahedra.push_back({a + nodes, b + nodes, c + nodes, d + nodes});
    for (auto* of_each : {&both.mesh.regions, &both.mesh.outside_labels})
        std::ranges::copy(std::vector(*of_each), std::back_inserter(*of_each));
    for (const std::int32_t node : one.fixed_nodes) both.fixed_nodes.push_back(node + nodes);
    for (const std::int32_t node : one.contact_nodes) both.contact_nodes.push_back(node + nodes);
    both.boundary = boundary_surface(both.mesh);
    both.compliance = DenseCompliance{static_cast<std::int32_t>(both.contact_nodes.size()), {}};
    both.certificate.free_dofs = 2 * one.certificate.free_dofs;
    both.obb_tree = median_tree(both.boundary.surface, 4);
    return with_true_compliance(std::move(both));
}

DeformableBody true_elastic_arch(int cells, double radius) {
    DeformableBody body = elastic_cube(cells);
    for (auto* positions : {&body.mesh.rest_positions, &body.boundary.surface.vertices})
        for (Eigen::Vector3d& p : *positions)
            p.z() *= 1 - (radius - std::sqrt(radius * radius - (p.x() - 10) * (p.x() - 10))) / 20;
    body.obb_tree = median_tree(body.boundary.surface, 4);
    return with_true_compliance(std::move(body));
}

DeformableBody with_contact_nodes(DeformableBody body, const std::vector<std::int32_t>& contact_nodes) {
    const auto& whole = std::get<DenseCompliance>(body.compliance);
    const std::size_t dofs = 3 * contact_nodes.size();
    const auto whole_dof = [&](std::size_t dof) {
        const auto block = std::ranges::lower_bound(body.contact_nodes, contact_nodes[dof / 3]);
        return 3 * static_cast<std::size_t>(block - body.contact_nodes.begin()) + dof % 3;
    };
    const std::shared_ptr<float[]> entries(new float[dofs * dofs]);
    for (std::size_t i = 0; i < dofs; ++i)
        for (std::size_t j = 0; j < dofs; ++j) entries[i * dofs + j] = whole.row(whole_dof(i))[whole_dof(j)];
    body.compliance = DenseCompliance{static_cast<std::int32_t>(contact_nodes.size()),
                                      std::shared_ptr<const float>(entries, entries.get())};
    body.contact_nodes = contact_nodes;
    return body;
}

}  // namespace palpate::sample
