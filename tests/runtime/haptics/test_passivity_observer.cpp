// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <functional>
#include <gtest/gtest.h>

#include "runtime/haptics/passivity_observer.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

constexpr double watched_coupling = 0.5;  // N/mm
constexpr double watched_twist = 450;     // N mm/rad

// A contact that is whatever a test says, under the observer, and what a hand got from it.
class WatchedContact {
  public:
    struct Tick {
        Vector3d force;  // N, on the device
        std::uint32_t status;
    };

    explicit WatchedContact(double length = 0, bool is_instrument = false)
        : observer_(1, length, is_instrument) {}

    Tick tick(const Vector3d& tip, const Vector3d& wanted, std::uint32_t faults = no_fault,
              const Vector3d& shaft = Vector3d::Zero(),
              const Eigen::Quaterniond& orientation = {0, 0, 0, 0}) {
        work_ += force_of(result_).dot(tip - tip_);
        tip_ = tip;
        const ContactPose pose{.tip = tip, .shaft = shaft, .orientation = orientation, .trusted = true};
        result_.status = tick_ok;
        result_.faults = faults;
        Vector3d force = wanted;
        observer_.damp({&pose, 1}, {watched_coupling, watched_twist}, {&result_, 1}, {&force, 1});
        result_.force = {force[0], force[1], force[2]};
        result_.contact_count = wanted.isZero(0) ? 0 : 1;
        result_.contacts[0].normal = {0, 0, 1};
        result_.contacts[0].force = static_cast<float>(wanted.norm());
        observer_.hold({&result_, 1});
        return {force, result_.status};
    }
    double work() const { return work_; }  // on the hand, N mm

  private:
    PassivityObserver observer_;
    TickResult result_{};
    Vector3d tip_ = Vector3d::Zero();
    double work_ = 0;
};

TEST(PassivityObserver, a_spring_that_is_read_once_a_tick_is_left_alone) {
    WatchedContact contact;
    for (int k = 0; k < 5000; ++k) {
        const double z = 3 * std::cos(0.05 * k);  // 150 mm/s at the most
        const Vector3d force(0, 0, watched_coupling * std::max(0.0, -z));
        const auto tick = contact.tick({0, 0, z}, force);
        ASSERT_EQ(tick.status, tick_ok) << k;
        ASSERT_EQ(tick.force, force) << k;
    }
}

// Pushes along one half of a circle and not against the other: each way round gives energy.
TEST(PassivityObserver, what_gives_energy_is_damped_to_what_sampling_explains) {
    WatchedContact contact;
    double sampling = 0, undamped = 0;
    int counted = 0;
    Vector3d last(3, 0, 0);
    contact.tick(last, Vector3d::Zero());
    for (int k = 1; k <= 6283; ++k) {
        const Vector3d tip = 3 * Vector3d(std::cos(1e-2 * k), std::sin(1e-2 * k), 0);
        const Vector3d way = tip - last;
        const Vector3d force(0, way[1] > 0 ? 0.2 : 0.1, 0);
        sampling += watched_coupling * way.norm() * (way.norm() / 2 + PassivityObserver::resolution);
        undamped += force.dot(way);
        const auto tick = contact.tick(tip, force);
        counted += (tick.status & energy_injected) != 0;
        ASSERT_GE(tick.force.dot(way), std::min(0.0, force.dot(way)) - 1e-12)
            << "no more than the force itself";
        last = tip;
    }
    EXPECT_GT(undamped, 5);
    EXPECT_GT(counted, 1000);
    EXPECT_LE(contact.work(), sampling + 0.2 * 0.03) << "one tick late";
}

// 5 mm/s on encoders of 0.03 mm: most ticks see no motion, and must not give the force back.
TEST(PassivityObserver, coarse_encoders_hide_no_energy) {
    WatchedContact contact;
    double sampling = 0;
    contact.tick(Vector3d::Zero(), Vector3d::Zero());
    Vector3d last = Vector3d::Zero();
    for (int k = 1; k <= 2000; ++k) {
        const Vector3d tip(0.03 * std::floor(0.005 * k / 0.03), 0, 0);
        const double way = (tip - last).norm();
        sampling += watched_coupling * way * (way / 2 + PassivityObserver::resolution);
        contact.tick(tip, {0.2, 0, 0});
        last = tip;
    }
    EXPECT_LE(contact.work(), sampling + 0.2 * 0.03);
}

TEST(PassivityObserver, every_touch_has_its_own_account) {
    WatchedContact contact;
    // Paid a lot while touching the first time, which says nothing of the second.
    for (int k = 0; k < 100; ++k) contact.tick({0, 0, -0.02 * k}, {0, 0, 1});
    contact.tick({0, 0, 5}, Vector3d::Zero());
    contact.tick({0, 0, 5}, Vector3d::Zero());
    int counted = 0;
    for (int k = 0; k < 100; ++k)
        counted += (contact.tick({0, 0, 5 + 0.02 * k}, {0, 0, 1}).status & energy_injected) != 0;
    EXPECT_GT(counted, 50);
}

TEST(PassivityObserver, what_a_fault_took_away_is_not_held_against_contact) {
    WatchedContact contact;
    for (int k = 0; k < 100; ++k) contact.tick({0, 0, -0.02 * k}, Vector3d(0, 0, 0.01 * k), motors_warm);
    for (int k = 100; k > 0; --k)
        ASSERT_EQ(contact.tick({0, 0, -0.02 * k}, Vector3d(0, 0, 0.01 * k)).status, tick_ok);
}

TEST(PassivityObserver, a_shaft_that_turns_may_have_stored_what_its_tip_gives_back) {
    WatchedContact contact(50);
    contact.tick({0, 0, 0}, {0, 0, 1}, no_fault, Vector3d::UnitX());
    contact.tick({0, 0, 0}, {0, 0, 1}, no_fault, Vector3d(std::cos(0.1), 0, std::sin(0.1)));
    // 1 N on 50 mm by 0.1 rad: 5 N mm.
    double z = 0;
    for (int k = 1; k <= 49; ++k) {
        z = 0.1 * k;
        ASSERT_EQ(
            contact.tick({0, 0, z}, {0, 0, 1}, no_fault, Vector3d(std::cos(0.1), 0, std::sin(0.1))).status,
            tick_ok)
            << z;
    }
}

TEST(PassivityObserver, of_an_instrument_a_turn_about_its_shaft_counts_too) {
    const auto status_after = [](bool is_instrument) {
        WatchedContact contact(50, is_instrument);
        const Eigen::Quaterniond turned(Eigen::AngleAxisd(0.1, Vector3d::UnitZ()));
        contact.tick({0, 0, 0}, {0, 0, 1}, no_fault, Vector3d::UnitZ(), Eigen::Quaterniond::Identity());
        contact.tick({0, 0, 0}, {0, 0, 1}, no_fault, Vector3d::UnitZ(), turned);
        std::uint32_t status = tick_ok;
        for (int k = 1; k <= 49; ++k)
            status |= contact.tick({0, 0, 0.1 * k}, {0, 0, 1}, no_fault, Vector3d::UnitZ(), turned).status;
        return status;
    };
    EXPECT_EQ(status_after(true), tick_ok);
    EXPECT_EQ(status_after(false), energy_injected);
}

// A contact that only turns what it touches, and what a hand that feels torque got from it.
class WatchedTurn {
  public:
    static constexpr double length = 50;  // mm, of the tool

    WatchedTurn() : observer_(1, length, true) { observer_.count_torque(0, true); }

    std::uint32_t tick(double angle, double wanted) {
        work_ += result_.torque[0] * (angle - angle_);
        angle_ = angle;
        const ContactPose pose{.orientation = Eigen::Quaterniond(Eigen::AngleAxisd(angle, Vector3d::UnitX())),
                               .trusted = true};
        result_.status = tick_ok;
        result_.torque = {wanted, 0, 0};
        result_.contact_count = 1;
        Vector3d force = Vector3d::Zero();
        observer_.damp({&pose, 1}, {watched_coupling, watched_twist}, {&result_, 1}, {&force, 1});
        observer_.hold({&result_, 1});
        return result_.status;
    }
    double torque() const { return result_.torque[0]; }
    double work() const { return work_; }  // N mm

  private:
    PassivityObserver observer_;
    TickResult result_{};
    double angle_ = 0, work_ = 0;
};

TEST(PassivityObserver, a_torsional_spring_that_is_felt_is_left_alone) {
    WatchedTurn contact;
    for (int k = 0; k < 5000; ++k) {
        const double angle = 0.3 * std::sin(0.05 * k);  // 15 rad/s at the most
        ASSERT_EQ(contact.tick(angle, -watched_twist * angle), tick_ok) << k;
        ASSERT_EQ(contact.torque(), -watched_twist * angle) << k;
    }
}

TEST(PassivityObserver, torque_that_gives_energy_is_damped_to_what_sampling_explains) {
    WatchedTurn contact;
    double sampling = 0, undamped = 0, last = 0;
    int counted = 0;
    for (int k = 0; k < 6283; ++k) {
        const double angle = 0.3 * std::sin(1e-2 * k), turn = angle - last;
        const double torque = turn > 0 ? 40 : 20;  // as if it fell behind the hand by turns
        sampling += watched_twist * std::abs(turn) *
                    (std::abs(turn) / 2 + PassivityObserver::resolution / WatchedTurn::length);
        undamped += torque * turn;
        counted += (contact.tick(angle, torque) & energy_injected) != 0;
        ASSERT_GE(contact.torque(), -1e-12);
        ASSERT_LE(contact.torque(), torque);
        last = angle;
    }
    EXPECT_GT(undamped, 100);
    EXPECT_GT(counted, 1000);
    EXPECT_LE(contact.work(), sampling + 40 * 0.003) << "one tick late";
}

TEST(PassivityObserver, never_moves_on_tissue_and_walls) {
    Case c = sample::sample_case();
    c.deformable_bodies = {sample::true_elastic_cube(3)};
    HapticModel model(c);
    TickResult result{};
    int touched = 0, injected = 0;
    for (int tick = 0; tick < 20000; ++tick) {
        const double t = 1e-3 * tick;
        const Vector3d tip(20 + 18 * std::sin(1.1 * t), 10 + 9 * std::sin(2.3 * t + 1),
                           21 + 7 * std::cos(5.1 * t));
        model.tick(held_at(tip), result);
        touched += result.contact_count > 0;
        injected += (result.status & energy_injected) != 0;
    }
    EXPECT_GT(touched, 4000);
    EXPECT_EQ(injected, 0);
}

}  // namespace
}  // namespace palpate
