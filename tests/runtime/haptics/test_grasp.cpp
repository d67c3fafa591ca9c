// SPDX-License-Identifier: Apache-2.0
// Two tools that pinch tissue between them, hold it by friction and draw it away, as a forceps' jaws do.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <functional>
#include <gtest/gtest.h>
#include <memory>

#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

constexpr double friction = 0.6;
constexpr double rounding = 1e-6;  // N: of float32 in contacts
const Vector3d up(0, 0, 1);

// What both hands did and felt in one tick.
struct Moment {
    std::array<TickResult, 2> jaws;
    double work = 0;  // N mm, so far, on both hands
    Vector3d force() const { return force_of(jaws[0]) + force_of(jaws[1]); }
};

// Jaws of 1 mm at either side of the soft cube, 4 mm below its top, as rods of `length` (mm) upwards.
class Grasp : public ::testing::TestWithParam<double> {
  protected:
    static Case cube() {
        Case c = soft_cube(4);
        c.haptics.friction_at_rest = c.haptics.friction_sliding = friction;
        c.haptics.shaft_length = GetParam();
        return c;
    }

    // Goes on until the jaws are `pinch` mm in from either side and `lift` mm up.
    void go(
        double pinch, double lift, int ticks,
        const std::function<void(const Moment&)>& look = [](const Moment&) {}) {
        const double from_pinch = pinch_, from_lift = lift_;
        for (int tick = 1; tick <= ticks; ++tick) {
            pinch_ = from_pinch + (pinch - from_pinch) * tick / ticks;
            lift_ = from_lift + (lift - from_lift) * tick / ticks;
            const double height = 16 + lift_;
            const std::array places{Vector3d(-1 + pinch_, 10.3, height), Vector3d(21 - pinch_, 10.3, height)};
            const std::array devices{held_at(places[0], up), held_at(places[1], up)};
            const Moment before = moment_;
            model_->tick(devices, moment_.jaws);
            for (std::size_t jaw = 0; begun_ && jaw < 2; ++jaw)
                moment_.work += 0.5 * (force_of(moment_.jaws[jaw]) + force_of(before.jaws[jaw]))
                                          .dot(places[jaw] - places_[jaw]);
            begun_ = true;
            places_ = places;
            look(moment_);
        }
    }

    // Of the cube's surface, mm.
    std::vector<Vector3f> displacements() const {
        std::vector<Vector3f> of_one(case_.deformable_bodies[0].boundary.nodes.size(), Vector3f::Zero()),
            sum = of_one;
        for (const TickResult& jaw : moment_.jaws) {
            model_->surface_displacement(0, jaw, of_one);
            for (std::size_t v = 0; v < sum.size(); ++v) sum[v] += of_one[v];
        }
        return sum;
    }

    const Case case_ = cube();
    std::unique_ptr<HapticModel> model_ = std::make_unique<HapticModel>(case_, usual_contact_method, 2);
    Moment moment_{};
    std::array<Vector3d, 2> places_;
    double pinch_ = -2, lift_ = 0;
    bool begun_ = false;
};

TEST_P(Grasp, holds_tissue_by_coulombs_law_and_draws_it_along) {
    go(-2, 0, 5);
    go(2, 0, 400);
    const double pressed = force_of(moment_.jaws[0]).x();
    EXPECT_LT(pressed, -0.01);
    EXPECT_NEAR(force_of(moment_.jaws[1]).x(), -pressed, 0.05 * -pressed);  // the mesh is not symmetric
    const std::vector<Vector3f> still = displacements();
    double pull = 0;
    int unsettled = 0;
    go(2, 0.5, 200, [&](const Moment& now) {
        pull = std::max(pull, -now.force().z());
        if ((now.jaws[0].status | now.jaws[1].status) & contact_unsettled) ++unsettled;
        for (const TickResult& jaw : now.jaws) {
            EXPECT_EQ(jaw.status & ~std::uint32_t{contact_unsettled}, 0U);
            EXPECT_LE(drag_of(jaw).norm(), friction * press_of(jaw) + rounding);
        }
    });
    EXPECT_LE(unsettled, 4);  // by more than 10 um
    EXPECT_GT(pull, 0.1 * -pressed);
    // It follows.
    const std::vector<Vector3f> drawn = displacements();
    float most = 0;
    for (std::size_t v = 0; v < drawn.size(); ++v) most = std::max(most, drawn[v].z() - still[v].z());
    EXPECT_GT(most, 0.02F);
}

// Coulomb's friction of smooth jaws would bear less than a tenth of what the pull comes to.
TEST_P(Grasp, by_grip_draws_tissue_far_and_keeps_it) {
    Case c = case_;
    c.haptics.friction_at_rest = c.haptics.friction_sliding = 0.05;
    c.haptics.grip = 0.2;
    model_ = std::make_unique<HapticModel>(c, usual_contact_method, 2);
    go(-2, 0, 5);
    go(4, 0, 800);
    Vector3d last = moment_.force();
    const std::vector<Vector3f> still = displacements();
    double pull = 0, step = 0;
    const auto look = [&](const Moment& now) {
        step = std::max(step, (now.force() - last).norm());
        last = now.force();
        pull = std::max(pull, -last.z());
        for (const TickResult& jaw : now.jaws) {
            EXPECT_GT(press_of(jaw), 0);
            EXPECT_EQ(jaw.status & contact_unsolved, 0U);
        }
    };
    go(4, 4, 800, look);
    go(4, 4, 300, look);
    EXPECT_LT(step, 0.1 * pull);  // the cube is of four cells along each side
    EXPECT_GT(-last.z(), 0.99 * pull);
    EXPECT_GT(pull, 10 * 0.05 * (press_of(moment_.jaws[0]) + press_of(moment_.jaws[1])));
    const std::vector<Vector3f> drawn = displacements();
    float most = 0;
    for (std::size_t v = 0; v < drawn.size(); ++v) most = std::max(most, drawn[v].z() - still[v].z());
    EXPECT_GT(most, 1.5);  // of 4 mm; what a drag shears and the couplings take the rest
}

TEST_P(Grasp, slips_when_more_than_friction_bears_is_asked_of_it) {
    go(-2, 0, 5);
    go(2, 0, 400);
    double pull = 0, last = 0;
    go(2, 15, 3000, [&](const Moment& now) {
        last = -now.force().z();
        pull = std::max(pull, last);
    });
    EXPECT_GT(pull, 0.01);
    EXPECT_LT(last, 0.5 * pull);  // past the cube's top there is nothing to hold
}

TEST_P(Grasp, lets_go_without_a_kick) {
    go(-2, 0, 5);
    go(2, 0, 400);
    double most = 0;
    go(2, 0.5, 200, [&](const Moment& now) { most = std::max(most, now.force().norm()); });
    Vector3d last = moment_.force();
    double kick = 0;
    go(-2, 0.5, 400, [&](const Moment& now) {
        kick = std::max(kick, (now.force() - last).norm());
        last = now.force();
    });
    EXPECT_EQ(last.norm(), 0);
    EXPECT_LT(kick, 0.1 * most);
}

TEST_P(Grasp, takes_energy_from_the_hand_on_every_round) {
    go(-2, 0, 5);
    double before = 0, stored = 0;
    for (int round = 0; round < 3; ++round) {
        for (const auto& [pinch, lift] :
             {std::pair{2.0, 0.0}, {2.0, 0.7}, {1.2, 0.7}, {2.2, 0.2}, {-2.0, 0.0}})
            go(pinch, lift, 200, [&](const Moment& now) { stored = std::max(stored, before - now.work); });
        EXPECT_LT(moment_.work, before);
        before = moment_.work;
    }
    EXPECT_GT(stored, 0.01);
}

// One jaw waits beside the cube, where it touches nothing; the other pushes the tissue against it.
TEST_P(Grasp, a_jaw_feels_tissue_that_the_other_pushes_against_it) {
    for (const double friction_here : {0.0, friction}) {
        Case c = case_;
        c.haptics.friction_at_rest = c.haptics.friction_sliding = friction_here;
        HapticModel model(c, usual_contact_method, 2);
        std::array<TickResult, 2> jaws{};
        for (int tick = 0; tick <= 600; ++tick) {
            const double pushed = std::min(0.01 * tick, 5.0);
            model.tick(std::array{held_at({-2 + pushed, 10.3, 17}, up), held_at({21.3, 10.3, 17}, up)}, jaws);
        }
        EXPECT_GT(force_of(jaws[1]).x(), 0.001) << friction_here;
        for (const TickResult& jaw : jaws) EXPECT_EQ(jaw.status & contact_unsolved, 0U) << friction_here;
    }
}

INSTANTIATE_TEST_SUITE_P(Jaws, Grasp, ::testing::Values(0.0, 5.0),
                         [](const auto& length) { return length.param > 0 ? "rods" : "tips"; });

}  // namespace
}  // namespace palpate
