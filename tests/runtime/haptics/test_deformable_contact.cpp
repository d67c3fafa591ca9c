// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <optional>
#include <string>

#include "formats/model/errors.hpp"
#include "runtime/haptics/contact/god_object.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/elastic_cube.hpp"
#include "tests/runtime/haptics/equilibrium_oracle.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

// A press on the true elastic cube (20 mm, held below, 5 kPa), with limits wide enough not to show.
class DeformableContactTest : public ::testing::Test {
  protected:
    explicit DeformableContactTest(double tool_radius = 3) {
        case_.name = "cube";
        case_.deformable_bodies.push_back(body());
        case_.haptics = {
            .tool_radius = tool_radius, .coupling_stiffness = 0.5, .max_force = 50, .max_force_rate = 50};
        model_.emplace(case_);
    }

    static const DeformableBody& body() {
        static const DeformableBody instance = sample::true_elastic_cube(5);
        return instance;
    }

    // The tool's centre goes to `p`.
    const TickResult& go(const Vector3d& p) {
        realtime::DeviceState state;
        state.position = {p[0], p[1], p[2]};
        model_->tick(state, result_);
        return result_;
    }
    Vector3d force() const { return Eigen::Map<const Vector3d>(result_.force.data()); }
    // The hand goes from device_ to `to`, straight and slowly; looks now and then.
    template <typename Look>
    void walk(const Vector3d& to, Look look) {
        const Vector3d from = device_;
        const int steps = static_cast<int>(std::ceil((to - from).norm() / 0.01));
        for (int step = 1; step <= steps; ++step) {
            const Vector3d next = from + (to - from) * step / steps;
            const Vector3d before = force();
            go(next);
            work_ -= 0.5 * (force() + before).dot(next - device_);
            device_ = next;
            most_work_ = std::max(most_work_, work_);
            if (step % 50 == 0) look();
        }
    }

    Case case_;
    std::optional<HapticModel> model_;
    TickResult result_{};
    Vector3d device_ = Vector3d::Zero();  // where walk() goes on
    double work_ = 0, most_work_ = 0;     // of the hand on its walks, N mm
};

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

TEST_F(DeformableContactTest, forces_hold_the_tool_on_the_surface_that_the_whole_stiffness_displaces) {
    const EquilibriumOracle oracle(body());
    for (const Vector3d& place : {Vector3d(10.3, 9.4, 23), Vector3d(8.1, 8.2, 23), Vector3d(14, 5, 23)})
        for (const double depth : {0.5, 1.5, 3.0}) {
            model_->reset();
            go(place + Vector3d(0, 0, 3));
            for (int tick = 0; tick < 5; ++tick) go(place - Vector3d(0, 0, depth));
            ASSERT_GT(press_of(result_), 0.001) << place.transpose() << " " << depth;
            EXPECT_EQ(result_.status, tick_ok);
            oracle.expect_equilibrium({&result_, 1}, 3, model_->coupling(), 2e-3);
            EXPECT_LE(result_.residual, 1e-6);
        }
}

// The work of a hand that goes in and along, and the energy that the whole stiffness then holds.
TEST_F(DeformableContactTest, the_hands_work_is_what_tissue_sinking_in_and_coupling_hold) {
    const EquilibriumOracle oracle(body());
    go({9, 8, 26});
    const auto look = [&] {
        EXPECT_NEAR(work_, oracle.energy(result_, 3, model_->coupling()), 0.01 * most_work_)
            << device_.transpose();
    };
    device_ = {9, 8, 23.001};
    for (const Vector3d& corner : {Vector3d(9, 8, 21), Vector3d(12, 8, 21), Vector3d(12, 11, 20.5),
                                   Vector3d(8, 12, 21), Vector3d(9, 8, 21)})
        walk(corner, look);
    const double there = work_;
    // Round a closed way and back to where it began.
    for (const Vector3d& corner :
         {Vector3d(12, 8, 21), Vector3d(12, 11, 20.5), Vector3d(8, 12, 21), Vector3d(9, 8, 21)})
        walk(corner, look);
    EXPECT_NEAR(work_, there, 0.01 * most_work_);
}

// On the cube's side, where what a load is spread over is partly held: at z = 0 it is fixed.
class SmallToolTest : public DeformableContactTest {
  protected:
    SmallToolTest() : DeformableContactTest(1) {}
};
TEST_F(SmallToolTest, takes_no_work_for_a_closed_way_beside_what_is_fixed) {
    go({26, 9, 6});
    device_ = {21.001, 9, 6};
    walk({20, 9, 6}, [] {});
    const double there = work_;
    for (const Vector3d& corner :
         {Vector3d(20, 13, 6), Vector3d(20, 12, 10), Vector3d(20.5, 8, 11), Vector3d(20, 9, 6)})
        walk(corner, [] {});
    EXPECT_GT(press_of(result_), 0);
    EXPECT_NEAR(work_, there, 0.01 * there);
}

TEST_F(SmallToolTest, takes_no_work_for_a_closed_way_over_triangles_with_a_held_corner) {
    const EquilibriumOracle oracle(body());
    for (const double z : {0.5, 1.0, 2.0, 3.0}) {
        model_->reset();
        work_ = most_work_ = 0;
        const auto look = [&] {
            EXPECT_NEAR(work_, oracle.energy(result_, 1, model_->coupling()), 0.01 * most_work_) << z;
        };
        go({26, 9, z});
        device_ = {21.001, 9, z};
        walk({20, 9, z}, look);
        oracle.expect_equilibrium({&result_, 1}, 1, model_->coupling(), 2e-3);
        const double there = work_;
        for (const Vector3d& corner :
             {Vector3d(20, 13, z), Vector3d(20, 12, z + 3), Vector3d(20.5, 8, z + 3), Vector3d(20, 9, z)})
            walk(corner, look);
        EXPECT_GT(press_of(result_), 0) << z;
        EXPECT_NEAR(work_, there, 0.01 * there) << z;
        RecordProperty("part_of_the_work_at_" + std::to_string(z), std::to_string((work_ - there) / there));
    }
}

// Tissue pressed flat has triangles that turn over, which a few ticks find no equilibrium on.
TEST_F(SmallToolTest, slides_over_what_tissue_is_held_by_at_its_back_and_is_not_taken_for_inside) {
    const auto at_the_back = [&](const Contact& contact) {
        return std::ranges::all_of(contact.vertices, [&](std::int32_t v) {
            return body().boundary.surface.vertices[static_cast<std::size_t>(v)].z() < 1e-9;
        });
    };
    int ticks = 0, unsolved = 0, borne_by_the_back = 0;
    for (const double z : {0.5, -0.5, -1.5})
        for (const double y : {6.0, 9.4, 12.0}) {
            model_->reset();
            go({6, y, 26});
            for (double down = 21; down > z; down -= 0.2) go({6, y, down});
            for (double x = 6; x < 14; x += 0.02) {
                go({x, y, z});
                ++ticks;
                unsolved += result_.status != tick_ok ? 1 : 0;
                borne_by_the_back += std::ranges::any_of(result_.active_contacts(), at_the_back) ? 1 : 0;
            }
        }
    EXPECT_GT(borne_by_the_back, ticks / 4);
    EXPECT_LE(unsolved, ticks / 100);
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
    // Loads spread no farther than the rim, which is two elements off.
    const Vector3d felt = go(whole, result_, within);
    EXPECT_NEAR((go(part, result_, within) - felt).norm(), 0, 0.01 * felt.norm());

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
    constexpr double rim_share = 0.1;  // of the way
    constexpr double refinement = 10,
                     slack = 1.5;         // where the force bends, a fine step catches the steepest place
    const Vector3d start(10, 9.7, 21.5);  // 1.5 mm deep
    constexpr double way = 7;             // mm, to x = 17 mm, in a triangle that C leaves out wholly
    HapticModel part(part_);
    double stiffest = 0;
    const auto largest_change = [&](int steps) {
        part.reset();
        go(part, result_, start + Vector3d(0, 0, 5));
        const Vector3d soft = go(part, result_, start);
        Vector3d last = soft;
        double largest = 0, stiff = 0;
        int unsettled = 0;
        for (int step = 1; step <= 2 * steps; ++step) {  // there and back
            const double x = way * (step <= steps ? step : 2 * steps - step) / steps;
            const Vector3d force = go(part, result_, start + Vector3d(x, 0, 0));
            largest = std::max(largest, (force - last).norm());
            stiff = std::max(stiff, force.z());
            EXPECT_EQ(result_.status & ~contact_unsettled, tick_ok);  // where the foot leaves what gives way
            unsettled += result_.status != tick_ok;
            last = force;
        }
        // As it crosses the rim, where what a sphere sinks into ends: once there, once back. Should none be
        // left, another test must see that unsettled ticks are told.
        EXPECT_GT(unsettled, 0);
        EXPECT_LE(unsettled, steps * rim_share);
        EXPECT_GT(stiff, 2 * soft.z());
        stiffest = std::max(stiffest, stiff);
        // A solved contact does not remember the way.
        EXPECT_NEAR((last - soft).norm(), 0, 1e-4 * soft.norm());
        return largest;
    };
    const double coarse = largest_change(350);  // 0.02 mm, 20 mm/s at 1 kHz
    // Half a per cent is what the search for the equilibrium may leave for the next tick.
    const double fine = largest_change(3500);
    EXPECT_LE(fine, slack * coarse / refinement + 0.005 * stiffest);
}

TEST_F(DeformableContactTest, refuses_a_compliance_of_another_body) {
    Case wrong = case_;
    wrong.deformable_bodies.front().contact_nodes.pop_back();
    EXPECT_THROW(HapticModel{wrong}, InvalidInput);
}

}  // namespace
}  // namespace palpate
