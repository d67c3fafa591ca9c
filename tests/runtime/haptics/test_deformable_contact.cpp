// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>

#include "formats/model/errors.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/elastic_cube.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

// A press on the true elastic cube (20 mm, held below, 5 kPa), with limits wide enough not to show.
class DeformableContactTest : public ::testing::Test {
  protected:
    static const Case& cube() {
        static const Case instance = [] {
            Case c;
            c.name = "cube";
            c.deformable_bodies.push_back(sample::true_elastic_cube(5));
            c.haptics = {.tool_radius = 3, .coupling_stiffness = 0.5, .max_force = 50, .max_force_rate = 50};
            return c;
        }();
        return instance;
    }
    static const DeformableBody& body() { return cube().deformable_bodies.front(); }

    // The tool's centre goes to `p`.
    const TickResult& go(const Vector3d& p) {
        realtime::DeviceState state;
        state.position = {p[0], p[1], p[2]};
        model_.tick(state, result_);
        return result_;
    }
    Vector3d force() const { return Eigen::Map<const Vector3d>(result_.force.data()); }

    HapticModel model_{cube()};
    TickResult result_{};
};

// Solves K u = load with the recorded contacts as constraints, on the whole stiffness matrix and behind a
// virtual coupling (N/mm): an independent way to the contact forces.
Eigen::VectorXd direct_forces(const DeformableBody& body, std::span<const Contact> contacts,
                              double coupling) {
    const Eigen::MatrixXd K = sample::dense_stiffness(body.mesh, sample::soft_tissue());
    std::vector<const Contact*> active;
    for (const Contact& contact : contacts)
        if (contact.force > 0) active.push_back(&contact);
    const Eigen::Index n = K.rows(), m = static_cast<Eigen::Index>(active.size());
    Eigen::MatrixXd system = Eigen::MatrixXd::Zero(n + m, n + m);
    Eigen::VectorXd right = Eigen::VectorXd::Zero(n + m);
    system.topLeftCorner(n, n) = K;
    for (Eigen::Index k = 0; k < m; ++k) {
        const Contact& contact = *active[static_cast<std::size_t>(k)];
        for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i)
            for (Eigen::Index axis = 0; axis < 3; ++axis) {
                const Eigen::Index dof =
                    3 * body.boundary.nodes[static_cast<std::size_t>(contact.vertices[i])] + axis;
                const double entry = static_cast<double>(contact.weights[i]) *
                                     static_cast<double>(contact.normal[static_cast<std::size_t>(axis)]);
                system(dof, n + k) += entry;  // K u + n f = 0
                system(n + k, dof) -= entry;  // -n . u + c f = delta
            }
        for (Eigen::Index l = 0; l < m; ++l)
            system(n + k, n + l) =
                normal_of(contact).dot(normal_of(*active[static_cast<std::size_t>(l)])) / coupling;
        system(n + k, n + k) += static_cast<double>(contact.series_compliance);
        right[n + k] = static_cast<double>(contact.gap);
    }
    for (const std::int32_t node : body.fixed_nodes)
        for (Eigen::Index dof = 3 * node; dof < 3 * node + 3; ++dof) {
            system.row(dof).setZero();
            system(dof, dof) = 1;
        }
    return system.partialPivLu().solve(right).tail(m);
}

TEST_F(DeformableContactTest, a_press_grows_with_depth_and_ends_with_release) {
    go({10.3, 9.4, 26});
    double last = 0;
    for (int step = 1; step <= 300; ++step) {
        go({10.3, 9.4, 23 - 0.01 * step});
        EXPECT_GT(force().z(), last) << step;
        EXPECT_EQ(result_.status, tick_ok);
        EXPECT_NEAR(result_.depth, 0.01 * step, 2 * GodObject::skin);
        last = force().z();
    }
    EXPECT_GT(last, 0.05);
    for (int step = 300; step >= 1; --step) {
        go({10.3, 9.4, 23 - 0.01 * step});
        EXPECT_GT(force().z(), 0);
    }
    go({10.3, 9.4, 23.01});
    EXPECT_EQ(force().norm(), 0);
    EXPECT_EQ(result_.contact_count, 0);
}

TEST_F(DeformableContactTest, forces_are_those_of_a_direct_solve_on_the_whole_stiffness) {
    for (const Vector3d& place : {Vector3d(10.3, 9.4, 23), Vector3d(8.1, 8.2, 23), Vector3d(14, 5, 23)})
        for (const double depth : {0.5, 1.5, 3.0}) {
            model_.reset();
            go(place + Vector3d(0, 0, 3));
            go(place - Vector3d(0, 0, depth));
            const Eigen::VectorXd expected =
                direct_forces(body(), result_.active_contacts(), model_.coupling());
            ASSERT_GT(expected.size(), 0);
            double sum = 0;
            for (const Contact& contact : result_.active_contacts())
                sum += static_cast<double>(contact.force);
            EXPECT_NEAR(sum, expected.sum(), 1e-4 * expected.sum()) << place.transpose() << " " << depth;
            EXPECT_LE(result_.residual, 1e-6);
        }
}

TEST_F(DeformableContactTest, the_displaced_surface_leaves_the_tool_and_no_contact_pulls) {
    go({8.1, 8.2, 26});
    go({8.1, 8.2, 21});
    std::vector<Eigen::Vector3f> u(body().boundary.nodes.size());
    model_.surface_displacement(0, result_, u);
    ASSERT_GT(result_.contact_count, 1);
    const Eigen::Vector3f backed = (force() / model_.coupling()).cast<float>();  // the tool, on its coupling
    for (const Contact& contact : result_.active_contacts()) {
        EXPECT_GE(contact.force, 0);
        Eigen::Vector3f moved = Eigen::Vector3f::Zero();
        for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i)
            moved += contact.weights[i] * u[static_cast<std::size_t>(contact.vertices[i])];
        moved -= backed;
        const float given = -moved.dot(Eigen::Map<const Eigen::Vector3f>(contact.normal.data())) +
                            contact.series_compliance * contact.force;
        EXPECT_GE(given, contact.gap - 1e-4F);  // float32 displacements of a few mm
        if (contact.force > 0) {
            EXPECT_NEAR(given, contact.gap, 1e-4F);
        }
    }
    for (std::size_t v = 0; v < u.size(); ++v)
        if (body().boundary.surface.vertices[v].z() == 0) {
            EXPECT_EQ(u[v].norm(), 0) << "fixed vertex " << v;
        }
}

TEST_F(DeformableContactTest, sliding_at_50_mm_per_s_changes_the_force_without_jumps) {
    go({4, 9.7, 26});
    go({4, 9.7, 20});
    Vector3d last = force();
    for (int tick = 1; tick <= 240; ++tick) {  // over a dozen edges and past four vertices
        go({4 + 0.05 * tick, 9.7 + 0.01 * tick, 20});
        EXPECT_LE((force() - last).norm(), 0.5) << tick;
        EXPECT_LE((force() - last).norm(), 0.03 * last.norm()) << tick;
        last = force();
    }
}

TEST_F(DeformableContactTest, a_foot_on_fixed_nodes_is_as_stiff_as_the_coupling) {
    go({10.4, 9.3, -6});
    go({10.4, 9.3, -2});
    EXPECT_NEAR(force().z(), -0.5 * 1.0, 1e-3);
    EXPECT_EQ(result_.contacts[0].series_compliance, 0);
}

// The cube's top is contact surface as far as x = 12 mm and free surface that C leaves out beyond.
class PartialContactSurface : public ::testing::Test {
  protected:
    static constexpr double rim = 12;

    PartialContactSurface() {
        const DeformableBody whole = sample::true_elastic_cube(5);
        std::vector<std::int32_t> part;
        for (const std::int32_t node : whole.contact_nodes)
            if (whole.mesh.rest_positions[static_cast<std::size_t>(node)].x() <= rim + 1e-9)
                part.push_back(node);
        for (Case* c : {&whole_, &part_}) {
            c->name = "cube";
            c->haptics = {.tool_radius = 3, .coupling_stiffness = 0.5, .max_force = 50, .max_force_rate = 50};
        }
        whole_.deformable_bodies = {whole};
        part_.deformable_bodies = {sample::with_contact_nodes(whole, part)};
    }

    static Vector3d go(HapticModel& model, TickResult& result, const Vector3d& p) {
        realtime::DeviceState state;
        state.position = {p[0], p[1], p[2]};
        model.tick(state, result);
        return Eigen::Map<const Vector3d>(result.force.data());
    }

    Case whole_, part_;
    TickResult result_{};
};

TEST_F(PartialContactSurface, feels_like_the_whole_one_within_it_and_rigid_beyond) {
    HapticModel whole(whole_), part(part_);
    const Vector3d within(4, 9.7, 22), beyond(18.5, 9.7, 22);  // 1 mm deep
    for (HapticModel* model : {&whole, &part}) go(*model, result_, within + Vector3d(0, 0, 4));
    EXPECT_EQ(go(part, result_, within), go(whole, result_, within));

    part.reset();
    go(part, result_, beyond + Vector3d(0, 0, 4));
    // As stiff as the coupling, 0.5 N/mm; the god-object's skin is 1e-4 mm.
    EXPECT_NEAR(go(part, result_, beyond).z(), 0.5 * 1.0, 1e-3);
    std::vector<Eigen::Vector3f> u(part_.deformable_bodies[0].boundary.nodes.size());
    part.surface_displacement(0, result_, u);
    for (const Eigen::Vector3f& displacement : u) EXPECT_EQ(displacement.norm(), 0);
}

TEST_F(PartialContactSurface, shows_no_displacement_beyond_its_rim) {
    HapticModel part(part_);
    go(part, result_, {11, 9.7, 26});
    go(part, result_, {11, 9.7, 21});
    const DeformableBody& body = part_.deformable_bodies[0];
    std::vector<Eigen::Vector3f> u(body.boundary.nodes.size());
    part.surface_displacement(0, result_, u);
    float largest = 0;
    for (std::size_t v = 0; v < u.size(); ++v)
        if (body.boundary.surface.vertices[v].x() > rim + 1e-9) {
            EXPECT_EQ(u[v].norm(), 0) << "vertex " << v;
        } else {
            largest = std::max(largest, u[v].norm());
        }
    EXPECT_GT(largest, 0.5F);
}

// The foot's share of contact surface falls from 1 to 0 within the rim's triangles, 12 to 16 mm, and the
// force rises from the tissue's to the coupling's: steeply, but a step ten times as fine changes it a tenth
// as much.
TEST_F(PartialContactSurface, is_left_and_entered_without_a_jump_of_the_force) {
    constexpr double refinement = 10,
                     slack = 1.5;         // where the force bends, a fine step catches the steepest place
    const Vector3d start(10, 9.7, 21.5);  // 1.5 mm deep
    constexpr double way = 7;             // mm, to x = 17 mm, in a triangle that C leaves out wholly
    HapticModel part(part_);
    const auto largest_change = [&](int steps) {
        part.reset();
        go(part, result_, start + Vector3d(0, 0, 5));
        const Vector3d soft = go(part, result_, start);
        Vector3d last = soft;
        double largest = 0, stiff = 0;
        for (int step = 1; step <= 2 * steps; ++step) {  // there and back
            const double x = way * (step <= steps ? step : 2 * steps - step) / steps;
            const Vector3d force = go(part, result_, start + Vector3d(x, 0, 0));
            largest = std::max(largest, (force - last).norm());
            stiff = std::max(stiff, force.z());
            EXPECT_EQ(result_.status, tick_ok);
            last = force;
        }
        EXPECT_GT(stiff, 2 * soft.z());
        // A solved contact does not remember the way.
        EXPECT_NEAR((last - soft).norm(), 0, 1e-4 * soft.norm());
        return largest;
    };
    const double coarse = largest_change(350);  // 0.02 mm, 20 mm/s at 1 kHz
    EXPECT_LE(largest_change(3500), slack * coarse / refinement);
}

TEST_F(DeformableContactTest, refuses_a_compliance_of_another_body) {
    Case wrong = cube();
    wrong.deformable_bodies.front().contact_nodes.pop_back();
    EXPECT_THROW(HapticModel{wrong}, InvalidInput);
}

}  // namespace
}  // namespace palpate
