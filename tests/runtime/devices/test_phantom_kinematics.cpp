// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "runtime/devices/device_model.hpp"
#include "tests/runtime/devices/phantom_kinematics.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

TEST(PhantomKinematics, gives_the_inkwell_pose_that_a_touch_was_recorded_in) {
    // Recorded by SOFA's Geomagic plugin; the configuration's lengths hold within a hundredth of a
    // millimetre.
    const Vector3d tip = tip_of(touch_arm, {0, 0.26889, -0.370813});
    EXPECT_LT((tip - Vector3d(0, -65.5107, -88.1142)).norm(), 0.01);
}

TEST(PhantomKinematics, all_joints_at_zero_are_the_pose_of_an_arm_without_data) {
    EXPECT_LT((tip_of(touch_arm, Vector3d::Zero()) - Vector3d(0, -110, -35)).norm(), 1e-12);
}

TEST(PhantomKinematics, positions_go_to_joints_and_back_all_over_the_workspace) {
    const devices::DeviceModel& model = devices::find_device_model("touch");
    constexpr double rounding = 1e-9;  // mm
    for (int i = 0; i <= 16; ++i)
        for (int j = 0; j <= 16; ++j)
            for (int k = 0; k <= 16; ++k) {
                Vector3d tip;
                const int steps[3]{i, j, k};
                for (std::size_t axis = 0; axis < 3; ++axis)
                    tip[static_cast<Eigen::Index>(axis)] =
                        std::lerp(model.workspace_low[axis], model.workspace_high[axis], steps[axis] / 16.0);
                const auto joints = joints_of(touch_arm, tip);
                ASSERT_TRUE(joints) << tip.transpose();
                EXPECT_LT((tip_of(touch_arm, *joints) - tip).norm(), rounding) << tip.transpose();
            }
}

TEST(PhantomKinematics, joints_go_to_positions_and_back) {
    std::mt19937 random(3);
    std::uniform_real_distribution<double> uniform(0, 1);
    const PhantomArm uneven{120, 150, {1, 2, 3}};
    for (const PhantomArm& arm : {touch_arm, uneven})
        for (int trial = 0; trial < 1000; ++trial) {
            // The elbow opens by t2 - t3 + pi/2, kept clear of a stretched and a folded arm.
            const double upper = uniform(random) - 0.3, opening = 0.4 + 1.4 * uniform(random);
            const Vector3d joints(2 * uniform(random) - 1, upper, upper + std::numbers::pi / 2 - opening);
            const auto found = joints_of(arm, tip_of(arm, joints));
            ASSERT_TRUE(found);
            EXPECT_LT((*found - joints).norm(), 1e-9) << joints.transpose();
        }
}

TEST(PhantomKinematics, nothing_reaches_beyond_the_stretched_arm_or_turns_to_its_own_axis) {
    const Vector3d turret = touch_arm.offset + Vector3d(0, touch_arm.fore, -touch_arm.upper);
    const double stretched = touch_arm.upper + touch_arm.fore;
    EXPECT_FALSE(joints_of(touch_arm, turret + Vector3d(0, 0, stretched + 1e-6)));
    EXPECT_TRUE(joints_of(touch_arm, turret + Vector3d(0, 0, stretched - 1e-6)));
    EXPECT_FALSE(joints_of(touch_arm, turret + Vector3d(0, -50, 0)));
}

}  // namespace
}  // namespace palpate
