// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <random>
#include <utility>

#include "formats/model/errors.hpp"
#include "formats/records/tick_result.hpp"
#include "runtime/haptics/contact/body_pair.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/elastic_cube.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Index;
using Eigen::MatrixXd;
using Eigen::Vector3d;
using Eigen::VectorXd;

constexpr double edge = 20;      // mm, of the cubes
constexpr double depth = 0.5;    // mm, by which B is pressed into A
constexpr double inside = 1e-6;  // mm by which a node may stay inside
// Compliances are float32; what both sides compute from the same entries agrees far better.
constexpr double stored = 2e-5;
const Vector3d mirrored(1, 1, -1), inverted(-1, -1, -1);

// Turns a body by signs of its axes, moves it by `shift`, and makes it `factor` times as compliant.
DeformableBody turned(DeformableBody body, const Vector3d& signs, const Vector3d& shift, double factor = 1) {
    for (Vector3d& p : body.mesh.rest_positions) p = signs.cwiseProduct(p) + shift;
    if (signs.prod() < 0)
        for (auto& tetrahedron : body.mesh.tetrahedra) std::swap(tetrahedron[2], tetrahedron[3]);
    body.boundary = boundary_surface(body.mesh);
    body.obb_tree = sample::median_tree(body.boundary.surface, 4);
    for (RegionMaterial& region : body.materials) region.material.youngs_modulus /= factor;
    auto& compliance = std::get<DenseCompliance>(body.compliance);
    const std::size_t n = compliance.dof_count();
    const std::shared_ptr<float[]> entries(new float[n * n]);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            entries[i * n + j] =
                static_cast<float>(signs[static_cast<Index>(i % 3)] * signs[static_cast<Index>(j % 3)] *
                                   factor * static_cast<double>(compliance.row(i)[j]));
    compliance.entries = std::shared_ptr<const float>(entries, entries.get());
    return body;
}

BodyPair pair_of(const DeformableBody& a, const DeformableBody& b) {
    return {ElasticSurface(a), ElasticSurface(b)};
}

// A cube held below, and its point reflection above it, off by (2, 1): their faces at z = 20 touch.
const DeformableBody& lower() {
    static const DeformableBody body = sample::true_elastic_cube(5);
    return body;
}
DeformableBody upper(const DeformableBody& cube, double factor = 1) {
    return turned(cube, inverted, {edge + 2, edge + 1, 2 * edge}, factor);
}
Vector3d pressed(double by) {
    return {0, 0, -by};
}

// Every free node of the top of A against the vertex of B above it, and the other way round, for a B that is
// A's mirror image: what detection would find if faces had no rim.
std::vector<PairContact> face_to_face(const BodyPair& bodies) {
    std::vector<PairContact> contacts;
    for (const std::size_t node_body : {std::size_t{0}, std::size_t{1}})
        for (std::size_t v = 0; v < bodies[node_body].vertices().size(); ++v) {
            if (bodies[node_body].vertices()[v].z() != edge) continue;
            const auto node = static_cast<std::int32_t>(v);
            for (const Triangle& t : bodies[1 - node_body].triangles()) {
                const auto flat = [&](std::int32_t corner) {
                    return bodies[1 - node_body].vertices()[static_cast<std::size_t>(corner)].z() == edge;
                };
                const auto corner = std::ranges::find(t, node);
                if (corner == t.end() || !std::ranges::all_of(t, flat)) continue;
                contacts.push_back({.node_body = node_body,
                                    .node = node,
                                    .polygon = t,
                                    .weights = Vector3d::Unit(corner - t.begin()),
                                    .normal = {0, 0, -1},
                                    .gap = depth});
                break;
            }
        }
    return contacts;
}

Vector3d net(const std::vector<VertexForce>& forces) {
    Vector3d sum = Vector3d::Zero();
    for (const VertexForce& load : forces) sum += load.force;
    return sum;
}

double imbalance(const PairForces& forces) {
    return (net(forces[0]) + net(forces[1])).norm() / std::max(net(forces[0]).norm(), net(forces[1]).norm());
}

// The two bodies as one system, from their stiffness: rows of G are what contacts measure of the vertices'
// displacements, C is the inverse of both stiffnesses.
struct WholeSystem {
    MatrixXd C, G;
    VectorXd delta;

    WholeSystem(const DeformableBody& a, const DeformableBody& b, std::span<const PairContact> contacts) {
        const std::array<const DeformableBody*, 2> bodies{&a, &b};
        std::array<Index, 2> first{0, static_cast<Index>(3 * a.mesh.rest_positions.size())};
        const Index n = first[1] + static_cast<Index>(3 * b.mesh.rest_positions.size());
        C = MatrixXd::Zero(n, n);
        for (std::size_t s = 0; s < 2; ++s) {
            MatrixXd K = sample::dense_stiffness(bodies[s]->mesh, bodies[s]->materials.front().material);
            for (const std::int32_t node : bodies[s]->fixed_nodes)
                K.diagonal().segment<3>(3 * node).array() += 1e9;
            C.block(first[s], first[s], K.rows(), K.rows()) =
                K.llt().solve(MatrixXd::Identity(K.rows(), K.rows()));
        }
        G = MatrixXd::Zero(static_cast<Index>(contacts.size()), n);
        delta.resize(static_cast<Index>(contacts.size()));
        for (Index k = 0; k < delta.size(); ++k) {
            const PairContact& contact = contacts[static_cast<std::size_t>(k)];
            const auto add = [&](std::size_t s, std::int32_t vertex, double weight) {
                const Index node = bodies[s]->boundary.nodes[static_cast<std::size_t>(vertex)];
                G.block<1, 3>(k, first[s] + 3 * node) +=
                    (s == 0 ? weight : -weight) * contact.normal.transpose();
            };
            add(contact.node_body, contact.node, 1);
            for (std::size_t i = 0; i < 3; ++i)
                add(1 - contact.node_body, contact.polygon[i], contact.weights[static_cast<Index>(i)]);
            delta[k] = contact.gap;
        }
    }

    // Projected Gauss-Seidel on the contact forces, until they stand still.
    VectorXd contact_forces() const {
        const MatrixXd A = G * C * G.transpose();
        VectorXd f = VectorXd::Zero(delta.size());
        double change = 1;
        for (int round = 0; change > 1e-13 && round < 200000; ++round) {
            change = 0;
            for (Index k = 0; k < f.size(); ++k) {
                const double better = std::max(0.0, f[k] + (delta[k] - A.row(k).dot(f)) / A(k, k));
                change = std::max(change, std::abs(better - f[k]));
                f[k] = better;
            }
        }
        return f;
    }
};

TEST(BodyPair, detection_finds_the_nodes_inside_and_their_feet_both_ways) {
    const BodyPair bodies = pair_of(lower(), upper(lower()));
    const auto contacts = find_contacts(bodies, pressed(depth), 0);
    // Of the 6 x 6 nodes of each face, a row and a column have no counterpart.
    ASSERT_EQ(contacts.size(), 50U);
    for (const PairContact& contact : contacts) {
        EXPECT_NEAR(contact.gap, depth, 1e-6);
        EXPECT_NEAR((contact.normal - Vector3d(0, 0, -1)).norm(), 0, 1e-6);
        Vector3d foot = Vector3d::Zero();
        for (std::size_t i = 0; i < 3; ++i)
            foot += contact.weights[static_cast<Index>(i)] *
                    bodies[1 - contact.node_body].vertices()[static_cast<std::size_t>(contact.polygon[i])];
        const Vector3d offset_of_node = contact.node_body == 0 ? -pressed(depth) : pressed(depth);
        const Vector3d node =
            bodies[contact.node_body].vertices()[static_cast<std::size_t>(contact.node)] + offset_of_node;
        EXPECT_NEAR((node - foot).norm(), depth, 1e-6);
    }
    EXPECT_TRUE(find_contacts(bodies, pressed(-depth), 0.9 * depth).empty());
    EXPECT_EQ(find_contacts(bodies, pressed(-depth), 1.1 * depth).size(), 50U);
}

TEST(BodyPair, the_exact_solution_is_that_of_the_whole_stiffness_by_projected_gauss_seidel) {
    const DeformableBody& a = lower();
    const DeformableBody b = upper(sample::true_elastic_cube(4), 4);
    const BodyPair bodies = pair_of(a, b);
    const auto contacts = find_contacts(bodies, pressed(depth), 0.2);
    const PairSolution solution = solve_exactly(bodies, contacts);
    const WholeSystem whole(a, b, contacts);
    const VectorXd f = whole.contact_forces();
    const VectorXd w = whole.G * whole.C * whole.G.transpose() * f - whole.delta;
    double normal_force = 0;
    for (std::size_t k = 0; k < contacts.size(); ++k) {
        EXPECT_NEAR(solution.distances[k], w[static_cast<Index>(k)], stored * depth) << k;
        normal_force += f[static_cast<Index>(k)] * contacts[k].normal.z();
    }
    EXPECT_NEAR(net(solution.forces[0]).z(), normal_force, stored * std::abs(normal_force));
    EXPECT_NEAR(solution.energy, f.dot(whole.delta) / 2, stored * solution.energy);
}

TEST(BodyPair, exact_forces_balance_and_leave_no_node_inside) {
    const DeformableBody b = upper(sample::true_elastic_cube(4), 3);
    const BodyPair bodies = pair_of(lower(), b);
    for (const double by : {0.1, 0.5, 1.0, 1.9}) {
        const auto contacts = find_contacts(bodies, pressed(by), 0.2);
        const PairSolution solution = solve_exactly(bodies, contacts);
        EXPECT_LE(imbalance(solution.forces), 1e-14) << by;
        EXPECT_GE(std::ranges::min(solution.distances), -inside) << by;
        EXPECT_GT(net(solution.forces[1]).z(), 0) << by;
    }
}

TEST(BodyPair, point_reflection_reflects_the_exact_solution) {
    const BodyPair bodies = pair_of(lower(), upper(lower()));
    const auto contacts = find_contacts(bodies, pressed(depth), 0);
    const PairSolution solution = solve_exactly(bodies, contacts);
    const std::size_t half = contacts.size() / 2;
    for (std::size_t k = 0; k < half; ++k) {
        ASSERT_EQ(contacts[k].node, contacts[half + k].node);
        EXPECT_LE((solution.displacements[k][0] + solution.displacements[half + k][1]).norm(),
                  stored * depth);
    }
}

TEST(BodyPair, equal_cubes_face_to_face_give_way_by_half) {
    const BodyPair bodies = pair_of(lower(), turned(lower(), mirrored, {0, 0, 2 * edge}));
    const auto contacts = face_to_face(bodies);
    for (const PairSolution& solution :
         {solve_exactly(bodies, contacts), split_by_force_ratio(bodies, contacts)})
        for (std::size_t k = 0; k < contacts.size(); ++k) {
            EXPECT_NEAR(contacts[k].normal.dot(solution.displacements[k][0]), depth / 2, inside);
            EXPECT_NEAR(contacts[k].normal.dot(solution.displacements[k][1]), -depth / 2, inside);
        }
}

// Of real bodies face to face the compliances are never multiples of each other: what couples the normal to
// the lateral ways is mirrored, so lateral forces of a split, which sticks, add up. The made-up compliance of
// the sample cube has no such coupling.
TEST(BodyPair, the_ratio_is_exact_where_one_compliance_is_a_multiple_of_the_other) {
    const double factor = 4;
    const DeformableBody cube = sample::elastic_cube(5);
    const BodyPair bodies = pair_of(cube, turned(cube, mirrored, {0, 0, 2 * edge}, factor));
    const auto contacts = face_to_face(bodies);
    const PairSolution exact = solve_exactly(bodies, contacts),
                       split = split_by_force_ratio(bodies, contacts);
    EXPECT_LE(imbalance(split.forces), 1e-12);
    EXPECT_NEAR(split.energy, exact.energy, 1e-9 * exact.energy);
    for (std::size_t k = 0; k < contacts.size(); ++k)
        for (std::size_t body = 0; body < 2; ++body) {
            EXPECT_LE((split.displacements[k][body] - exact.displacements[k][body]).norm(), inside);
            const double part = (body == 0 ? 1 : -factor) / (1 + factor);
            EXPECT_LE((exact.displacements[k][body] - part * depth * contacts[k].normal).norm(), inside);
        }
}

TEST(BodyPair, no_displacement_that_parts_the_bodies_costs_less_than_the_exact_one) {
    const DeformableBody& a = lower();
    const DeformableBody b = upper(sample::true_elastic_cube(4), 2);
    const BodyPair bodies = pair_of(a, b);
    const auto contacts = find_contacts(bodies, pressed(depth), 0);
    const PairSolution exact = solve_exactly(bodies, contacts);
    const WholeSystem whole(a, b, contacts);
    const VectorXd best = whole.G.transpose() * whole.contact_forces();
    std::mt19937 generator(3);
    std::normal_distribution<double> normal;
    for (const double size : {0.0, 1e-4, 1e-3, 1e-2})
        for (int i = 0; i < 100; ++i) {
            // Any forces, on all nodes; their displacement is scaled until it parts the bodies.
            VectorXd forces = best;
            for (double& force : forces) force += size * best.lpNorm<Eigen::Infinity>() * normal(generator);
            const VectorXd u = whole.C * forces, apart = whole.G * u;
            double scale = 0;
            for (Index k = 0; k < apart.size(); ++k) {
                ASSERT_GT(apart[k], 0);
                scale = std::max(scale, whole.delta[k] / apart[k]);
            }
            EXPECT_GE(scale * scale * forces.dot(u) / 2, (1 - stored) * exact.energy);
        }
}

TEST(BodyPair, the_ratio_leaves_forces_unbalanced_where_deformation_spreads_differently) {
    const BodyPair bodies = pair_of(lower(), upper(sample::true_elastic_cube(4)));
    const auto contacts = find_contacts(bodies, pressed(depth), 0);
    EXPECT_GT(imbalance(split_by_force_ratio(bodies, contacts).forces), 0.01);
}

TEST(BodyPair, the_ratio_puts_a_node_on_the_polygon_where_no_other_contact_shares_it) {
    const BodyPair bodies = pair_of(lower(), upper(sample::true_elastic_cube(4), 3));
    const auto contacts = find_contacts(bodies, pressed(depth), 0);
    const std::vector<PairContact> one{contacts.front()};
    ASSERT_EQ(one.front().node_body, 0U);
    const PairSolution split = split_by_force_ratio(bodies, one);
    EXPECT_NEAR(split.distances.front(), 0, inside);
    EXPECT_EQ(split.forces[0].size(), 1U);
    EXPECT_EQ(split.forces[1].size(), 3U);
}

TEST(BodyPair, the_published_split_of_one_contact_is_that_by_hand) {
    const DeformableBody b = upper(sample::true_elastic_cube(4), 3);
    const BodyPair bodies = pair_of(lower(), b);
    const auto contacts = find_contacts(bodies, pressed(depth), 0);
    const PairContact& contact = contacts.front();
    const Vector3d way = contact.gap * contact.normal;
    const double f_a =
        bodies[0].compliance(contact.node, contact.node).inverse().eval().operator*(way).norm();
    Eigen::Matrix<double, 9, 9> C;
    for (Index i = 0; i < 3; ++i)
        for (Index j = 0; j < 3; ++j)
            C.block<3, 3>(3 * i, 3 * j) = bodies[1].compliance(contact.polygon[static_cast<std::size_t>(i)],
                                                               contact.polygon[static_cast<std::size_t>(j)]);
    const Eigen::Matrix<double, 9, 1> f = C.ldlt().solve(-way.replicate<3, 1>());
    const double f_b = (f.segment<3>(0) + f.segment<3>(3) + f.segment<3>(6)).norm() / 3;
    const PairSolution split = split_by_force_ratio(bodies, {&contact, 1});
    EXPECT_LE((split.displacements[0][0] - f_b / (f_a + f_b) * way).norm(), inside);
    EXPECT_LE((split.displacements[0][1] + f_a / (f_a + f_b) * way).norm(), inside);
}

TEST(BodyPair, more_contacts_than_the_solver_takes_are_solved_by_exchange) {
    const BodyPair bodies = pair_of(sample::true_elastic_cube(6), upper(sample::true_elastic_cube(6)));
    const auto contacts = find_contacts(bodies, pressed(depth), 0);
    ASSERT_GT(contacts.size(), max_contacts);
    const PairSolution solution = solve_exactly(bodies, contacts);
    EXPECT_GE(std::ranges::min(solution.distances), -inside);
    EXPECT_LE(imbalance(solution.forces), 1e-14);
}

TEST(BodyPair, what_is_held_leaves_all_the_way_to_the_other) {
    const DeformableBody held = sample::with_contact_nodes(lower(), {lower().contact_nodes.front()});
    ASSERT_LT(held.mesh.rest_positions[static_cast<std::size_t>(held.contact_nodes[0])].z(), edge);
    for (const BodyPair& bodies : {pair_of(held, upper(lower())), pair_of(lower(), upper(held))}) {
        const std::size_t giving =
            bodies[0].is_free(find_contacts(bodies, pressed(depth), 0)[0].node) ? 0 : 1;
        const auto contacts = find_contacts(bodies, pressed(depth), 0);
        for (const PairSolution& solution :
             {solve_exactly(bodies, contacts), split_by_force_ratio(bodies, {contacts.data(), 1})}) {
            EXPECT_GE(solution.distances.front(), -inside);
            EXPECT_EQ(solution.displacements.front()[1 - giving].norm(), 0);
            EXPECT_NEAR(contacts.front().normal.dot(solution.displacements.front()[giving]),
                        giving == 0 ? depth : -depth, inside);
        }
    }
}

TEST(BodyPair, without_contact_there_is_no_force) {
    const BodyPair bodies = pair_of(lower(), upper(lower()));
    const auto contacts = find_contacts(bodies, pressed(-depth), 1);
    ASSERT_FALSE(contacts.empty());
    for (const PairSolution& solution :
         {solve_exactly(bodies, contacts), split_by_force_ratio(bodies, contacts)}) {
        EXPECT_EQ(solution.energy, 0);
        EXPECT_TRUE(solution.forces[0].empty() && solution.forces[1].empty());
    }
}

TEST(BodyPair, held_vertices_neither_move_nor_are_moved) {
    const ElasticSurface surface(lower());
    const auto& nodes = lower().boundary.nodes;
    const auto vertex_of = [&](std::int32_t node) {
        return static_cast<std::int32_t>(std::ranges::find(nodes, node) - nodes.begin());
    };
    const std::int32_t held = vertex_of(lower().fixed_nodes.back()),
                       free = vertex_of(lower().contact_nodes[7]);
    EXPECT_TRUE(surface.is_free(free));
    EXPECT_FALSE(surface.is_free(held));
    EXPECT_EQ(surface.compliance(free, held).norm(), 0);
    EXPECT_EQ(surface.compliance(held, free).norm(), 0);
    EXPECT_EQ(surface.compliance(free, free), compliance_block(lower().compliance, 7, 7).cast<double>());
}

TEST(BodyPair, refuses_a_compliance_of_other_nodes) {
    DeformableBody body = lower();
    body.contact_nodes.pop_back();
    EXPECT_THROW(ElasticSurface{body}, InvalidInput);
}

}  // namespace
}  // namespace palpate
