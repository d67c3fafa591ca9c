// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <memory>
#include <random>
#include <vector>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "tests/runtime/allocation_trap.hpp"

namespace palpate {
namespace {

using namespace devices;
using Eigen::Vector3d;

constexpr double stepping_error = 1e-11;  // relative, of some thousand exact steps
constexpr HandImpedance no_hand{.stiffness = 0, .damping = 0};
constexpr double infinite = std::numeric_limits<double>::infinity();

// A tip of 50 g on ideal motors and encoders.
DeviceModel plain() {
    return {.name = "plain", .mass_kg = 0.05, .damping = 5e-4, .max_force = infinite};
}

HandPath at_origin() {
    return HandPath({{0, Vector3d::Zero()}});
}

// Lets go at 0.1 s and takes hold again at 0.6 s, 20 mm from there.
HandPath letting_go() {
    return HandPath({{0, {0, 0, 0}}, {0.1, {0, 0, 0}, false}, {0.2, {20, 0, 0}, false}, {0.6, {20, 0, 0}}});
}

Vector3d position_read(DynamicDevice& device, int tick) {
    const realtime::DeviceState state = device.read(1e-3 * tick);
    return Eigen::Map<const Vector3d>(state.position.data());
}

// Kinetic energy and that of the hand's spring towards the origin, N mm.
double energy_of(const DynamicDevice& device, const DeviceModel& model, const HandImpedance& hand) {
    return 0.5e-3 * model.mass_kg * device.velocity().squaredNorm() +
           0.5 * hand.stiffness * device.position().squaredNorm();
}

TEST(DynamicDevice, a_free_mass_slows_down_with_m_over_b) {
    DynamicDevice device(plain(), no_hand, at_origin());
    device.write({{2, -1, 0.5}});
    device.read(0.02);
    device.write({});
    const Vector3d position = device.position(), velocity = device.velocity();
    ASSERT_GT(velocity.norm(), 100);
    const double tau = 1e-3 * 0.05 / 5e-4, left = std::exp(-0.15 / tau);
    device.read(0.17);
    EXPECT_LT((device.velocity() - left * velocity).norm(), stepping_error * velocity.norm());
    EXPECT_LT((device.position() - position - tau * (1 - left) * velocity).norm(), stepping_error * 100);
}

TEST(DynamicDevice, without_damping_a_constant_force_accelerates_uniformly) {
    DeviceModel model = plain();
    model.damping = 0;
    DynamicDevice device(model, no_hand, at_origin());
    device.write({{0, 0, 2}});
    device.read(0.1);
    const double acceleration = 2 / 5e-5;  // mm/s²
    EXPECT_NEAR(device.velocity().z(), acceleration * 0.1, stepping_error * acceleration);
    EXPECT_NEAR(device.position().z(), acceleration * 0.005, stepping_error * acceleration);
}

TEST(DynamicDevice, a_constant_force_settles_where_the_hands_spring_bears_it) {
    const HandImpedance hand{.stiffness = 0.3, .damping = 2e-3};
    DynamicDevice device(plain(), hand, HandPath({{0, {1, 2, 3}}}));
    device.write({{0.6, 0, -0.9}});
    device.read(2);
    EXPECT_LT((device.position() - Vector3d(1 + 2, 2, 3 - 3)).norm(), 1e-9);
    EXPECT_LT(device.velocity().norm(), 1e-9);
}

TEST(DynamicDevice, lags_a_hand_that_moves_uniformly_by_what_its_own_damping_takes) {
    const HandImpedance hand{.stiffness = 0.3, .damping = 2e-3};
    DynamicDevice device(plain(), hand, HandPath({{0, {0, 0, 0}}, {3, {300, 0, 0}}}));
    device.read(2);
    EXPECT_NEAR(device.velocity().x(), 100, 1e-8);
    EXPECT_NEAR(device.position().x(), 200 - 5e-4 * 100 / 0.3, 1e-9);
}

TEST(DynamicDevice, swings_at_the_frequency_of_mass_and_spring) {
    DeviceModel model = plain();
    model.damping = 0;
    const HandImpedance spring{.stiffness = 0.5, .damping = 0};
    DynamicDevice device(model, spring, at_origin());
    device.write({{1, 0, 0}});
    const double omega = std::sqrt(0.5 / 5e-5);
    for (int tick = 1; tick <= 300; ++tick) {
        device.read(1e-3 * tick);
        EXPECT_NEAR(device.position().x(), 2 * (1 - std::cos(omega * 1e-3 * tick)), 1e-9);
    }
}

TEST(DynamicDevice, energy_never_grows_without_force) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> uniform(0, 1);
    const double noise = 1e-12;  // N mm
    for (int trial = 0; trial < 50; ++trial) {
        DeviceModel model = plain();
        model.mass_kg = 0.02 + 0.1 * uniform(random);
        model.damping = 2e-3 * uniform(random);
        model.coulomb_friction = trial % 2 * 0.3 * uniform(random);
        const HandImpedance hand{.stiffness = uniform(random), .damping = 4e-3 * uniform(random)};
        DynamicDevice device(model, hand, at_origin());
        device.write({{4 * uniform(random) - 2, 4 * uniform(random) - 2, 4 * uniform(random) - 2}});
        device.read(0.03);
        device.write({});
        double last = energy_of(device, model, hand);
        ASSERT_GT(last, 0);
        for (int step = 1; step <= 8000; ++step) {
            device.read(0.03 + step * DynamicDevice::step_s);
            const double now = energy_of(device, model, hand);
            ASSERT_LE(now, last + noise) << "trial " << trial << ", step " << step;
            last = now;
        }
    }
}

TEST(DynamicDevice, a_tip_at_rest_moves_only_beyond_its_friction) {
    DeviceModel model = plain();
    model.coulomb_friction = 0.26;
    DynamicDevice device(model, no_hand, at_origin());
    device.write({{0.15, -0.15, 0.14}});  // 0.254 N
    device.read(1);
    EXPECT_EQ(device.position(), Vector3d::Zero());
    device.write({{0.27, 0, 0}});
    device.read(1.1);
    EXPECT_GT(device.position().x(), 0);
    EXPECT_EQ(device.position().tail<2>().norm(), 0);
}

TEST(DynamicDevice, friction_stops_a_sliding_tip_after_m_v_squared_over_twice_the_friction) {
    DeviceModel model = plain();
    model.damping = 0;
    model.coulomb_friction = 0.2;
    DynamicDevice device(model, no_hand, at_origin());
    device.write({{0, 1.2, 0}});
    device.read(0.01);  // 1 N beyond friction
    device.write({});
    const double speed = device.velocity().norm(), start = device.position().y();
    EXPECT_NEAR(speed, 1 / 5e-5 * 0.01, 1e-9);
    device.read(1);
    EXPECT_NEAR(device.position().y() - start, 5e-5 * speed * speed / (2 * 0.2), 1e-9);
    EXPECT_EQ(device.velocity(), Vector3d::Zero());
}

TEST(DynamicDevice, encoders_round_down_to_their_resolution) {
    DeviceModel model = plain();
    model.encoder_resolution = 0.055;
    DynamicDevice device(model, no_hand, HandPath({{0, {0.12, -0.01, 1}}}));
    const Vector3d read = position_read(device, 0);
    EXPECT_NEAR(read.x(), 0.11, 1e-12);
    EXPECT_NEAR(read.y(), -0.055, 1e-12);
    EXPECT_NEAR(read.z(), 0.99, 1e-12);
    EXPECT_EQ(device.position(), Vector3d(0.12, -0.01, 1));
}

TEST(DynamicDevice, a_force_arrives_after_the_delay_and_stays_for_a_period) {
    for (const int delay : {0, 1, 3}) {
        DeviceModel model = plain();
        model.delay_ticks = delay;
        DynamicDevice device(model, no_hand, at_origin());
        Vector3d last = Vector3d::Zero();
        for (int tick = 0; tick < 8; ++tick) {
            device.read(1e-3 * tick);
            device.write({{tick == 0 ? 1.0 : 0.0, 0, 0}});
            device.read(1e-3 * (tick + 1));
            EXPECT_EQ(device.velocity().x() > last.x(), tick == delay) << delay << " ticks, tick " << tick;
            last = device.velocity();
        }
    }
}

TEST(DynamicDevice, motors_saturate_and_keep_the_direction) {
    DeviceModel model = plain();
    model.damping = 0;
    model.max_force = 2.5;
    DynamicDevice strong(model, no_hand, at_origin()), at_limit(model, no_hand, at_origin());
    strong.write({{30, 0, -40}});
    at_limit.write({{1.5, 0, -2}});
    strong.read(0.05);
    at_limit.read(0.05);
    EXPECT_LT((strong.position() - at_limit.position()).norm(), stepping_error * strong.position().norm());
}

TEST(DynamicDevice, where_it_goes_does_not_depend_on_how_often_it_is_asked) {
    DeviceModel model = plain();
    model.coulomb_friction = 0.1;
    const HandPath path({{0, {0, 0, 0}}, {0.05, {5, 1, 0}}, {0.08, {5, -3, 2}}});
    DynamicDevice asked(model, {}, path), left_alone(model, {}, path), asked_oddly(model, {}, path);
    for (int tick = 0; tick < 10; ++tick) {
        const std::array<double, 3> force{0.1 * tick, -0.2, 0};
        asked.write({force});
        left_alone.write({force});
        asked_oddly.write({force});
        for (int ms = 1; ms <= 10; ++ms) asked.read(1e-2 * tick + 1e-3 * ms);
        left_alone.read(1e-2 * (tick + 1));
        for (const double part : {0.37, 0.1, 1.0}) asked_oddly.read(1e-2 * (tick + part));
        EXPECT_EQ(asked.position(), left_alone.position());
        EXPECT_EQ(asked.velocity(), left_alone.velocity());
        EXPECT_EQ(asked.position(), asked_oddly.position());
    }
}

TEST(DynamicDevice, the_same_calls_give_the_same_bits) {
    const auto run = [] {
        DynamicDevice device(find_device_model("touch"), {}, HandPath({{0, {0, 0, 0}}, {0.2, {20, 3, -4}}}));
        std::vector<double> positions;
        for (int tick = 0; tick < 400; ++tick) {
            const Vector3d p = position_read(device, tick);
            device.write({{-0.4 * std::max(0.0, p.x() - 3), 0.1, 0}});
            positions.insert(positions.end(), p.begin(), p.end());
        }
        return positions;
    };
    EXPECT_EQ(run(), run());
}

TEST(DynamicDevice, reading_and_writing_never_allocate) {
    DeviceModel model = find_device_model("touch");
    model.delay_ticks = 2;
    DynamicDevice device(model, {}, letting_go());
    const auto hand = std::make_shared<GuidedHand>(HandTarget{{1, 2, 3}, {0, 0, 0, 1}});
    DynamicDevice guided(model, {}, hand);
    const AllocationTrap trap;
    for (int tick = 0; tick < 700; ++tick) {
        for (DynamicDevice* each : {&device, &guided}) {
            each->read(1e-3 * tick);
            each->write({{-0.1, 0, 0.3}});
        }
        hand->set_target({{1, 2, 0.01 * tick}, {0, 0.6, 0, 0.8}});
    }
    EXPECT_EQ(trap.count(), 0U);
}

TEST(DynamicDevice, motors_warm_to_their_limit_after_tau_log_of_k_squared_over_k_squared_less_one) {
    DeviceModel model = plain();
    model.max_continuous_force = 0.9;
    model.thermal_time_s = 0.5;
    for (const double k : {1.1, 2.0, 3.5}) {  // times the force they bear for ever
        DynamicDevice device(model, {}, at_origin());
        const double warm_after = 0.5 * std::log(k * k / (k * k - 1));
        device.write({{0, -0.9 * k, 0}});
        const double tick = 1e-3;
        EXPECT_EQ(device.read(warm_after - tick).faults, no_fault) << k;
        EXPECT_LT(device.motor_temperature(), 1);
        EXPECT_EQ(device.read(warm_after + tick).faults, motors_warm) << k;
        device.read(2);
        EXPECT_NEAR(device.motor_temperature(), k * k * (1 - std::exp(-2 / 0.5)), stepping_error * k * k);
    }
}

TEST(DynamicDevice, motors_stay_warm_until_they_have_cooled_enough) {
    DeviceModel model = plain();
    model.max_continuous_force = 1;
    model.thermal_time_s = 0.5;
    DynamicDevice device(model, {}, at_origin());
    device.write({{2, 0, 0}});
    device.read(0.4);
    const double hot = device.motor_temperature();
    ASSERT_GT(hot, 1.5);
    device.write({});
    const double cool_at = 0.4 + 0.5 * std::log(hot / Motors::cool_enough);
    EXPECT_EQ(device.read(cool_at - 1e-3).faults, motors_warm);
    EXPECT_LT(device.motor_temperature(), 1);  // cooler than the limit and still not let on
    EXPECT_EQ(device.read(cool_at + 1e-3).faults, no_fault);
}

TEST(DynamicDevice, motors_bear_their_continuous_force_for_ever) {
    DeviceModel model = plain();
    model.max_continuous_force = 0.88;
    model.thermal_time_s = 0.01;
    DynamicDevice device(model, {}, at_origin());
    device.write({{0.88, 0, 0}});
    EXPECT_EQ(device.read(10).faults, no_fault);  // a thousand time constants
    EXPECT_NEAR(device.motor_temperature(), 1, 1e-9);
}

TEST(DynamicDevice, without_a_hand_it_moves_as_one_that_never_had_one) {
    DeviceModel model = plain();
    model.coulomb_friction = 0.05;
    DynamicDevice let_go(model, {}, letting_go()), alone(model, no_hand, at_origin());
    let_go.read(0.1 - DynamicDevice::step_s);
    EXPECT_EQ(let_go.position(), Vector3d::Zero());
    for (DynamicDevice* device : {&let_go, &alone}) {
        device->read(0.1 - DynamicDevice::step_s);
        device->write({{0, 0.4, 0}});
        device->read(0.2);
        device->write({});
        device->read(0.59);
    }
    ASSERT_GT(alone.position().y(), 10);
    EXPECT_LT((let_go.position() - alone.position()).norm(), stepping_error * 100);
    EXPECT_LT((let_go.velocity() - alone.velocity()).norm(), stepping_error * 100);
}

TEST(DynamicDevice, taking_hold_again_makes_no_jump_and_ends_at_the_wish) {
    const HandImpedance hand{.stiffness = 0.3, .damping = 2e-3};
    DynamicDevice device(plain(), hand, letting_go());
    device.read(0.6 - DynamicDevice::step_s);
    ASSERT_EQ(device.position(), Vector3d::Zero());
    Vector3d last = device.velocity();
    // At once the hand's damper takes 0.1 N to bring the tip to take_up_speed, then its spring what the tip
    // lags; pulled from 20 mm away, that spring alone would begin with 6 N.
    const double mass = 5e-5, hardest = 1.5 * hand.damping * DynamicDevice::take_up_speed;  // N s²/mm, N
    for (int step = 0; step < 16000; ++step) {
        device.read(0.6 + step * DynamicDevice::step_s);
        const double force = mass * (device.velocity() - last).norm() / DynamicDevice::step_s;
        ASSERT_LE(force, hardest) << step;
        EXPECT_LT(device.velocity().norm(), 1.7 * DynamicDevice::take_up_speed);
        last = device.velocity();
    }
    EXPECT_LT((device.position() - Vector3d(20, 0, 0)).norm(), 1e-3);
}

TEST(DynamicDevice, a_guided_hand_draws_it_to_its_target) {
    const auto hand = std::make_shared<GuidedHand>(HandTarget{{1, 2, 3}}, 200);
    DynamicDevice device(plain(), {}, hand);
    EXPECT_EQ(position_read(device, 0), Vector3d(1, 2, 3));
    hand->set_target({{101, 2, 3}});
    position_read(device, 450);
    EXPECT_NEAR(device.velocity().x(), 200, 0.1);  // the hand's speed, when the spring has stopped swinging
    EXPECT_LT((position_read(device, 1500) - Vector3d(101, 2, 3)).norm(), 1e-6);
    EXPECT_EQ(device.name(), "simulated plain, guided by mouse and keyboard");
}

TEST(DynamicDevice, turns_as_the_hand_wishes_whatever_the_force) {
    const auto about_x = [](double angle) {
        return Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitX()));
    };
    const HandPath path({{0, {0, 0, 0}, true, about_x(0)}, {1, {0, 0, 0}, true, about_x(2)}});
    DynamicDevice device(plain(), {}, path, {0, 1, 0});
    for (int tick = 0; tick <= 1000; tick += 125) {
        const realtime::DeviceState state = device.read(1e-3 * tick);
        device.write({{1, -2, 3}});
        const double angle = 2e-3 * tick;
        EXPECT_LT((quaternion_of(state.orientation).coeffs() - about_x(angle).coeffs()).norm(),
                  stepping_error);
        EXPECT_LT((vector_of(state.shaft) - Vector3d(0, -std::sin(angle), std::cos(angle))).norm(),
                  stepping_error);
    }
}

TEST(DynamicDevice, has_the_orientation_of_its_hand_before_the_first_step_and_none_where_the_hand_has_none) {
    const Eigen::Quaterniond held(Eigen::AngleAxisd(1, Vector3d::UnitY()));
    DynamicDevice device(plain(), {}, HandPath({{0, {0, 0, 0}, true, held}}));
    EXPECT_EQ(device.read(0).orientation, array_of(held));
    DynamicDevice unturned(plain(), {}, at_origin(), {0, 1, 0});
    unturned.read(0.01);
    EXPECT_EQ(unturned.read(0.02).orientation, (std::array<double, 4>{0, 0, 0, 0}));
    EXPECT_EQ(unturned.read(0.02).shaft, (std::array<double, 3>{0, 1, 0}));
}

TEST(DynamicDevice, tells_its_limits) {
    const DeviceModel& model = find_device_model("desktop");
    const DeviceLimits limits = DynamicDevice(model, {}, at_origin()).limits();
    EXPECT_EQ(limits.max_force, 7.9);
    EXPECT_EQ(limits.max_stiffness, 1.0);
    EXPECT_EQ(limits.damping, model.damping);
    EXPECT_EQ(limits.max_continuous_force, 1.75);
    EXPECT_EQ(limits.rate_hz, 1000);
    EXPECT_EQ(limits.workspace_low, (std::array<double, 3>{-80, -60, -60}));
    EXPECT_EQ(limits.workspace_high, (std::array<double, 3>{80, 60, 60}));
}

TEST(DynamicDevice, refuses_figures_that_no_device_has) {
    const auto refused = [](const std::function<void(DeviceModel&, HandImpedance&)>& spoil) {
        DeviceModel model = plain();
        HandImpedance hand;
        spoil(model, hand);
        EXPECT_THROW(DynamicDevice(model, hand, at_origin()), InvalidInput);
    };
    refused([](DeviceModel& m, HandImpedance&) { m.mass_kg = 0; });
    refused([](DeviceModel& m, HandImpedance&) { m.damping = -1e-6; });
    refused([](DeviceModel& m, HandImpedance&) { m.coulomb_friction = std::nan(""); });
    refused([](DeviceModel& m, HandImpedance&) { m.encoder_resolution = -1; });
    refused([](DeviceModel& m, HandImpedance&) { m.max_force = std::nan(""); });
    refused([](DeviceModel& m, HandImpedance&) { m.delay_ticks = -1; });
    refused([](DeviceModel& m, HandImpedance&) { m.max_continuous_force = -1; });
    refused([](DeviceModel& m, HandImpedance&) { m.thermal_time_s = 0; });
    refused([](DeviceModel&, HandImpedance& h) { h.stiffness = -0.1; });
    refused([](DeviceModel&, HandImpedance& h) { h.damping = infinite; });
}

TEST(DeviceModel, a_model_is_damped_so_that_its_stated_stiffness_is_the_most_at_1_khz) {
    ASSERT_EQ(device_models().size(), 4U);
    for (const DeviceModel& model : device_models())
        EXPECT_NEAR(2 * model.damping / 1e-3, model.max_stiffness, 1e-12) << model.name;
    const DeviceModel& turned = find_device_model("premium-6dof");
    EXPECT_NEAR(2 * turned.torsional_damping / 1e-3, turned.max_torsional_stiffness, 1e-9);
    EXPECT_NEAR(find_device_model("touch").damping, 0.25e-3, 1e-15);  // 0.25 N s/m
    EXPECT_EQ(find_device_model("premium").mass_kg, 0.075);
}

TEST(DeviceModel, a_model_has_a_workspace_and_bears_less_for_ever_than_at_most) {
    for (const DeviceModel& model : device_models()) {
        EXPECT_GT(model.max_continuous_force, 0) << model.name;
        EXPECT_LT(model.max_continuous_force, model.max_force) << model.name;
        for (std::size_t axis = 0; axis < 3; ++axis)
            EXPECT_GE(model.workspace_high[axis] - model.workspace_low[axis], 70) << model.name;
    }
}

TEST(DeviceModel, is_known_by_what_a_device_calls_itself) {
    const auto name_of = [](const char* device) {
        const DeviceModel* model = model_of_device(device);
        return model ? model->name : "";
    };
    EXPECT_EQ(name_of("PHANTOM Omni 4711 'Left'"), "touch");
    EXPECT_EQ(name_of("PHANTOM Premium 1.5 'Default'"), "premium");
    EXPECT_EQ(name_of("PHANTOM Premium 1.5/6DOF 7"), "premium-6dof");
    EXPECT_EQ(name_of("Touch X 12"), "desktop");
    EXPECT_EQ(name_of("touch Default Device"), "touch");
    EXPECT_EQ(name_of("simulated desktop, scripted hand"), "desktop");
    EXPECT_EQ(name_of("simulated, scripted hand"), "");
    EXPECT_EQ(name_of("HDAPI device"), "");
}

TEST(DeviceModel, an_unknown_name_is_answered_with_the_known_ones) {
    try {
        find_device_model("falcon");
        FAIL() << "found";
    } catch (const UsageError& error) {
        EXPECT_STREQ(error.what(), "device model: falcon (expected touch, desktop, premium, premium-6dof)");
    }
}

}  // namespace
}  // namespace palpate
