// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/LU>
#include <algorithm>
#include <array>
#include <gtest/gtest.h>
#include <limits>
#include <span>

#include "formats/model/contact/compliance_blocks.hpp"
#include "formats/model/contact/local_indentation.hpp"
#include "runtime/collision/collision_surface.hpp"
#include "runtime/haptics/contact/inner_balls.hpp"
#include "runtime/haptics/contact/load_spread.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {

/// Takes the recorded forces of a frictionless tick to the whole stiffness matrix and looks where the surface
/// and the tools then are: an independent way to the equilibrium.
class EquilibriumOracle {
  public:
    /// `body_index`: of this body among all of the case's.
    explicit EquilibriumOracle(const DeformableBody& body, std::int32_t body_index = 0)
        : body_(body),
          body_index_(body_index),
          blocks_(compliance_blocks(body)),
          spread_(body, blocks_),
          surface_(body.boundary.surface, body.obb_tree, body.name),
          compliance_(inverse(body)) {}

    /// Displacement of each surface vertex under the contacts of all tools and neighbours, mm.
    std::vector<Eigen::Vector3d> displacements(std::span<const TickResult> results) const {
        const Eigen::VectorXd u = compliance_ * loads(results);
        std::vector<Eigen::Vector3d> moved;
        for (std::size_t v = 0; v < body_.boundary.nodes.size(); ++v) {
            Eigen::Vector3d mean = Eigen::Vector3d::Zero();
            for (const haptics::LoadSpread::Share& share : spread_.shares(static_cast<std::int32_t>(v)))
                mean += static_cast<double>(share.weight) * u.segment<3>(dof(share.vertex));
            moved.push_back(mean);
        }
        return moved;
    }

    /// What holds the fixed nodes, by the whole stiffness matrix, all together, N.
    Eigen::Vector3d base_reaction(std::span<const TickResult> results) const {
        const Eigen::VectorXd internal =
            sample::dense_stiffness(body_.mesh, sample::soft_tissue()) * (compliance_ * loads(results));
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const std::int32_t node : body_.fixed_nodes) sum += internal.segment<3>(3 * node);
        // What a load spreads onto fixed nodes they bear at once.
        for_each_load(results, [&](std::int32_t vertex, const Eigen::Vector3d& force) {
            double spread = 0;
            for (const haptics::LoadSpread::Share& share : spread_.shares(vertex))
                spread += static_cast<double>(share.weight);
            sum -= (1 - spread) * force;
        });
        return sum;
    }

    /// How far a tool of `radius` sinks into what gives way, as Hertz has it, mm.
    Eigen::Vector3d sunk(const TickResult& result, double radius) const {
        const Eigen::Vector3d force = force_on_what_gives_way(result);
        return local_indentation(force.norm(), radius, spread_.contact_modulus(), spread_.radius()).depth *
               force.normalized();
    }

    /// Expects that the tools touch the surface where it is displaced to, and are nowhere inside.
    void expect_equilibrium(std::span<const TickResult> results, double radius, double coupling,
                            double tolerance) const {
        const std::vector<Eigen::Vector3d> moved = displacements(results);
        const TriangleMesh& rest = body_.boundary.surface;
        for (const TickResult& result : results) {
            if (!(press_of(result) > 0)) continue;
            const Eigen::Vector3d tool = Eigen::Map<const Eigen::Vector3d>(result.device_position.data()) +
                                         force_of(result) / coupling;
            const Eigen::Vector3d into = sunk(result, radius);
            const std::vector<haptics::InnerBall> balls =
                haptics::inner_balls(rest, surface_, blocks_, radius);
            const auto centre = [&](std::int32_t vertex) -> Eigen::Vector3d {
                const auto v = static_cast<std::size_t>(vertex);
                return rest.vertices[v] + moved[v] + balls[v].inset -
                       (gives_way(vertex) ? into : Eigen::Vector3d::Zero());
            };
            double nearest = std::numeric_limits<double>::infinity();
            for (const Triangle& t : rest.triangles) {
                std::array<Eigen::Vector3d, 3> centres;
                Eigen::Vector3d radii;
                for (std::size_t i = 0; i < 3; ++i) {
                    centres[i] = centre(t[i]);
                    radii[static_cast<Eigen::Index>(i)] = balls[static_cast<std::size_t>(t[i])].radius;
                }
                nearest = std::min(nearest, distance_of_balls(tool, centres, radii));
            }
            EXPECT_NEAR(nearest, radius, tolerance);
            for (const Contact& contact : result.active_contacts()) {
                EXPECT_GE(contact.force, 0);
                Eigen::Vector3d point = Eigen::Vector3d::Zero();
                double ball = 0;
                for (std::size_t i = 0; i < 3; ++i) {
                    const auto weight = static_cast<double>(contact.weights[i]);
                    point += weight * centre(contact.vertices[i]);
                    ball += weight * balls[static_cast<std::size_t>(contact.vertices[i])].radius;
                }
                if (contact.force > 0) {
                    EXPECT_NEAR((tool - point).norm(), radius + ball, tolerance);
                    EXPECT_NEAR(((tool - point).normalized() - normal_of(contact)).norm(), 0, tolerance);
                }
            }
        }
    }

    const haptics::LoadSpread& spread() const { return spread_; }

    /// Elastic energy of the surface under its contacts, and of a tool's sinking in and coupling, N mm.
    double energy(const TickResult& result, double radius, double coupling) const {
        const std::vector<Eigen::Vector3d> moved = displacements({&result, 1});
        double energy = 0;
        for (const Contact& contact : result.active_contacts())
            for (std::size_t i = 0; i < 3; ++i)
                energy -= 0.5 * static_cast<double>(contact.force * contact.weights[i]) *
                          normal_of(contact).dot(moved[static_cast<std::size_t>(contact.vertices[i])]);
        // The work of sinking in is the integral of F ds, by steps.
        const double press = force_on_what_gives_way(result).norm();
        constexpr int steps = 2000;
        double last = 0;
        for (int k = 1; k <= steps; ++k) {
            const double f = press * k / steps;
            const double depth =
                local_indentation(f, radius, spread_.contact_modulus(), spread_.radius()).depth;
            energy += (f - 0.5 * press / steps) * (depth - last);
            last = depth;
        }
        return energy + force_of(result).squaredNorm() / (2 * coupling);
    }

  private:
    // The least distance of p from the balls between a triangle's corners, which is convex over it: by ever
    // smaller steps along the triangle from its middle.
    static double distance_of_balls(const Eigen::Vector3d& p, const std::array<Eigen::Vector3d, 3>& centres,
                                    const Eigen::Vector3d& radii) {
        const auto distance = [&](double b, double c) {
            const double a = 1 - b - c;
            return (p - a * centres[0] - b * centres[1] - c * centres[2]).norm() - a * radii[0] -
                   b * radii[1] - c * radii[2];
        };
        constexpr std::array<std::array<int, 2>, 6> ways{
            {{1, 0}, {0, 1}, {-1, 1}, {-1, 0}, {0, -1}, {1, -1}}};
        double b = 1.0 / 3, c = 1.0 / 3, least = distance(b, c);
        for (double step = 0.5; step > 1e-6; step *= 0.5)
            for (bool better = true; better;) {
                better = false;
                for (const auto& [along_b, along_c] : ways) {
                    const double next_b = b + step * along_b, next_c = c + step * along_c;
                    if (std::min({next_b, next_c, 1 - next_b - next_c}) < 0) continue;
                    const double here = distance(next_b, next_c);
                    if (here >= least) continue;
                    b = next_b;
                    c = next_c;
                    least = here;
                    better = true;
                }
            }
        return least;
    }

    bool gives_way(std::int32_t vertex) const { return blocks_[static_cast<std::size_t>(vertex)] >= 0; }

    Eigen::Vector3d force_on_what_gives_way(const TickResult& result) const {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const Contact& contact : result.active_contacts())
            for (std::size_t i = 0; i < 3; ++i)
                if (gives_way(contact.vertices[i]))
                    sum += static_cast<double>(contact.force * contact.weights[i]) * normal_of(contact);
        return sum;
    }

    Eigen::VectorXd loads(std::span<const TickResult> results) const {
        Eigen::VectorXd load = Eigen::VectorXd::Zero(compliance_.rows());
        for_each_load(results, [&](std::int32_t vertex, const Eigen::Vector3d& force) {
            for (const haptics::LoadSpread::Share& share : spread_.shares(vertex))
                load.segment<3>(dof(share.vertex)) += static_cast<double>(share.weight) * force;
        });
        return load;
    }

    template <typename Take>
    void for_each_load(std::span<const TickResult> results, const Take& take) const {
        for (const TickResult& result : results)
            for (const Contact& contact : result.active_contacts()) {
                const Eigen::Vector3d push = static_cast<double>(contact.force) * normal_of(contact);
                if (contact.other_body == body_index_) take(contact.other_vertex, push);
                if (contact.body != body_index_) continue;
                for (std::size_t i = 0; i < 3; ++i)
                    take(contact.vertices[i], -static_cast<double>(contact.weights[i]) * push);
            }
    }

    Eigen::Index dof(std::int32_t vertex) const {
        return 3 * body_.boundary.nodes[static_cast<std::size_t>(vertex)];
    }

    static Eigen::MatrixXd inverse(const DeformableBody& body) {
        Eigen::MatrixXd K = sample::dense_stiffness(body.mesh, sample::soft_tissue());
        for (const std::int32_t node : body.fixed_nodes)
            for (Eigen::Index k = 3 * node; k < 3 * node + 3; ++k) {
                K.row(k).setZero();
                K.col(k).setZero();
                K(k, k) = 1;
            }
        Eigen::MatrixXd C = K.inverse();
        for (const std::int32_t node : body.fixed_nodes)
            for (Eigen::Index k = 3 * node; k < 3 * node + 3; ++k) C(k, k) = 0;
        return C;
    }

    const DeformableBody& body_;
    std::int32_t body_index_;
    std::vector<std::int32_t> blocks_;
    haptics::LoadSpread spread_;
    collision::CollisionSurface surface_;
    Eigen::MatrixXd compliance_;
};

}  // namespace palpate
