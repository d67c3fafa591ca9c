// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/devices/jaws/grasp_script.hpp"
#include "runtime/devices/jaws/jaws.hpp"
#include "tests/runtime/devices/probe_device.hpp"

namespace palpate {
namespace {

using namespace devices;
using namespace realtime;
using Eigen::Quaterniond;
using Eigen::Vector3d;

constexpr double near = 1e-12;  // mm
constexpr JawSettings jaws{.jaw_length = 20, .jaw_radius = 2, .jaw_opening = 60, .jaw_friction = 0.8};
constexpr double opened = std::numbers::pi / 3;
const Quaterniond turned(Eigen::AngleAxisd(1.1, Vector3d(1, 2, -1).normalized()));

TEST(JawPlaces, closed_tips_touch_each_other_and_open_ones_turn_about_one_hinge) {
    const Vector3d meet(3, -4, 5);
    for (const double angle : {0.0, 0.3, opened}) {
        const auto [one, other] = jaw_places(meet, turned, jaws, angle);
        // In the forceps' frame.
        const Vector3d a = turned.conjugate() * (one.tip - meet), b = turned.conjugate() * (other.tip - meet);
        const double aside = jaws.jaw_radius + jaws.jaw_length * std::sin(angle / 2);
        EXPECT_NEAR(a.x(), aside, near);
        EXPECT_NEAR(b.x(), -aside, near);
        EXPECT_NEAR(a.y(), 0, near);
        EXPECT_NEAR(a.z(), jaws.jaw_length * (1 - std::cos(angle / 2)), near);
        EXPECT_NEAR(a.z(), b.z(), near);
        EXPECT_NEAR(one.shaft.dot(other.shaft), std::cos(angle), near);
        const Vector3d hinge = one.tip + jaws.jaw_length * one.shaft;
        EXPECT_NEAR(
            (turned.conjugate() * (hinge - meet) - Vector3d(jaws.jaw_radius, 0, jaws.jaw_length)).norm(), 0,
            1e-11);
    }
}

class JawsTest : public ::testing::Test {
  protected:
    DeviceState read(double time) {
        const DeviceState first = pair_[0]->read(time);
        other_ = pair_[1]->read(time);
        return first;
    }
    // Between the jaws, rad.
    double angle() const {
        return std::acos(std::min(1.0, vector_of(first_.shaft).dot(vector_of(other_.shaft))));
    }
    void at(double time) { first_ = read(time); }

    std::shared_ptr<ProbeDevice> probe_ = std::make_shared<ProbeDevice>();
    std::shared_ptr<std::atomic<bool>> keys_ = std::make_shared<std::atomic<bool>>(false);
    std::array<std::shared_ptr<Device>, 2> pair_ =
        jaws_of(probe_, jaws, {.orientation = turned, .closed = keys_});
    DeviceState first_, other_;
};

TEST_F(JawsTest, the_device_feels_both_and_each_has_half_of_what_it_bears) {
    at(0.001);
    pair_[0]->write({{1, 2, 3}});
    pair_[1]->write({{-1, 0.5, 0.25}});
    EXPECT_EQ(probe_->wrench.force, (std::array<double, 3>{0, 2.5, 3.25}));
    for (const auto& jaw : pair_) {
        EXPECT_EQ(jaw->limits().max_force, 1.5);
        EXPECT_EQ(jaw->limits().max_stiffness, 0.25);
        EXPECT_EQ(jaw->limits().damping, 5e-4);
        EXPECT_EQ(jaw->limits().max_torque, 0);
        EXPECT_EQ(jaw->limits().max_torsional_stiffness, 0);
    }
}

TEST_F(JawsTest, a_device_with_an_angle_of_its_own_opens_them_as_far_as_they_go) {
    for (const double told : {0.0, 0.4, opened, 3.0}) {
        probe_->state.jaw_angle = told;
        at(0.001);
        EXPECT_NEAR(angle(), std::min(told, opened), 1e-7);
    }
}

TEST_F(JawsTest, the_first_button_or_a_key_closes_them_at_a_steady_rate_and_they_open_after) {
    at(0.001);
    EXPECT_NEAR(angle(), opened, 1e-7);
    probe_->state.buttons = 1;
    at(0.051);
    EXPECT_NEAR(angle(), opened - 0.05 * closing_speed, 1e-7);
    probe_->state.buttons = 2;
    at(0.071);
    EXPECT_NEAR(angle(), opened - 0.03 * closing_speed, 1e-7);
    keys_->store(true);
    for (double t = 0.1; t < 2; t += 0.05) at(t);
    EXPECT_NEAR(angle(), 0, 1e-7);
    keys_->store(false);
    for (double t = 2; t < 4; t += 0.05) at(t);
    EXPECT_NEAR(angle(), opened, 1e-7);
}

TEST_F(JawsTest, they_stay_while_nobody_knows_where_the_device_is) {
    probe_->state.buttons = 1;
    at(0.001);
    probe_->state.faults = device_lost;
    for (double t = 0.05; t < 0.5; t += 0.05) at(t);
    EXPECT_EQ(first_.faults, device_lost);
    probe_->state.faults = no_fault;
    at(0.501);
    EXPECT_GT(angle(), opened - 0.1);
}

TEST_F(JawsTest, they_turn_as_the_device_says_and_where_it_does_not_as_they_are_held) {
    probe_->state.jaw_angle = 0;
    at(0.001);
    EXPECT_NEAR((vector_of(first_.shaft) - turned * Vector3d::UnitZ()).norm(), 0, near);
    probe_->state.shaft = {0, 1, 0};
    at(0.002);
    EXPECT_NEAR((vector_of(first_.shaft) - Vector3d::UnitY()).norm(), 0, near);
    probe_->state.orientation = {0, 0, 0, 1};
    at(0.003);
    EXPECT_NEAR((vector_of(first_.shaft) - Vector3d::UnitZ()).norm(), 0, near);
    EXPECT_NEAR((vector_of(first_.position) - vector_of(other_.position)).norm(), 2 * jaws.jaw_radius, near);
}

TEST(GraspPath, closes_about_the_tissue_draws_it_out_and_ends_open_outside) {
    const Grasp grasp{.meet = {1, 2, 3}, .orientation = turned, .thickness = 12, .depth = 10};
    const Vector3d out = turned * Vector3d::UnitZ();
    const HandPath path = grasp_path(grasp, jaws, {.pull = 5, .pinch = 0.75, .seconds = 1});
    const double closed = 2 * std::asin(0.25 * 12 / (2 * jaws.jaw_length));
    const auto keys = path.keys();
    EXPECT_NEAR((keys.front().position - (grasp.meet + 2 * grasp.depth * out)).norm(), 0, near);
    EXPECT_NEAR((keys.back().position - keys.front().position).norm(), 0, near);
    EXPECT_EQ(keys.front().jaw_angle, opened);
    EXPECT_EQ(keys.back().jaw_angle, opened);
    const auto farthest = std::ranges::find_if(keys, [&](const HandPath::Key& key) {
        return (key.position - (grasp.meet + 5 * out)).norm() < near;
    });
    ASSERT_NE(farthest, keys.end());
    EXPECT_NEAR(farthest->jaw_angle, closed, near);
    for (std::size_t k = 1; k < keys.size(); ++k) {
        const double seconds = keys[k].time - keys[k - 1].time;
        EXPECT_LE(std::abs(keys[k].jaw_angle - keys[k - 1].jaw_angle), closing_speed * seconds + near);
        EXPECT_LE((keys[k].position - keys[k - 1].position).norm(), 20 * seconds + 1e-9);
    }
    EXPECT_THROW(grasp_path(grasp, jaws, {.speed = 0}), UsageError);
    EXPECT_THROW(grasp_path(grasp, jaws, {.pull = -1}), UsageError);
}

}  // namespace
}  // namespace palpate
