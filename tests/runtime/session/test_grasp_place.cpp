// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/devices/jaws/jaws.hpp"
#include "runtime/session/jaws/grasp_place.hpp"
#include "runtime/session/jaws/joined_jaws.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace session;
using Eigen::Vector3d;

// The wall's cube [0, 20]³, held at z = 0, beside the skull's sphere of 15 mm about (40, 10, 10).
class GraspPlaceTest : public ::testing::Test {
  protected:
    const Case patient_case_ = sample::sample_case(4);
    const haptics::HapticModel model_{patient_case_};
    const JawSettings jaws_{.jaw_length = 16, .jaw_radius = 1, .jaw_opening = 120};
    GraspPlace choose(const JawSettings& jaws, const std::string& body = "",
                      std::optional<Vector3d> near = std::nullopt) const {
        return choose_grasp_place(patient_case_, model_, jaws, body, near);
    }
};

TEST_F(GraspPlaceTest, stands_astride_a_rim_with_the_tips_in_its_middle) {
    const GraspPlace place = choose(jaws_);
    EXPECT_EQ(model_.body_name(place.body), "wall");
    EXPECT_NEAR(place.grasp.thickness, 20, 1e-5);
    EXPECT_EQ(place.grasp.depth, 8);
    EXPECT_GT(place.grasp.meet.z(), 8);  // not where it is held
    const Vector3d aside = place.grasp.orientation * Vector3d::UnitX();
    EXPECT_NEAR(aside.dot(place.grasp.meet), aside.dot(Vector3d(10, 10, 10)), 1e-5);
    EXPECT_NEAR(place.grasp.orientation.norm(), 1, 1e-12);
}

TEST_F(GraspPlaceTest, open_jaws_come_there_clear_of_every_body) {
    for (const Vector3d& near : {Vector3d(10, 10, 20), Vector3d(0, 10, 15), Vector3d(20, 10, 15)}) {
        const GraspPlace place = choose(jaws_, "wall", near);
        for (const double back : {0.0, 5.0, 16.0})
            for (const auto& [tip, shaft] :
                 devices::jaw_places(place.grasp.meet + back * (place.grasp.orientation * Vector3d::UnitZ()),
                                     place.grasp.orientation, jaws_, 120 * std::numbers::pi / 180))
                for (double along = 0; along <= jaws_.jaw_length; along += 2)
                    for (std::size_t body = 0; body < model_.body_count(); ++body) {
                        EXPECT_TRUE(model_.surface(body).is_outside(tip + along * shaft));
                        EXPECT_FALSE(
                            model_.surface(body).closest_point(tip + along * shaft, 0.9 * jaws_.jaw_radius));
                    }
    }
}

TEST_F(GraspPlaceTest, refuses_what_does_not_fit_and_what_does_not_give_way) {
    EXPECT_THROW(choose({.jaw_length = 10, .jaw_radius = 1, .jaw_opening = 60}), InvalidInput);
    EXPECT_THROW(choose(jaws_, "skull"), UsageError);
    EXPECT_THROW(choose(jaws_, "wal"), UsageError);
}

TEST(JoinedJaws, is_what_the_hand_does_and_feels) {
    TickResult first{}, second{};
    first.device_position = {1, 2, 3};
    second.device_position = {3, 2, 5};
    first.tool_position = {0, 0, 0};
    second.tool_position = {2, 0, 0};
    first.force = {1, 0, 0};
    second.force = {-1, 0.5, 0};
    first.depth = 1;
    second.depth = 2;
    first.body = 3;
    second.body = 4;
    second.status = contact_unsettled;
    first.contact_count = 40;
    second.contact_count = 40;
    for (Contact& contact : first.contacts) contact.triangle = 5;
    for (Contact& contact : second.contacts) contact.triangle = 7;
    first.buttons = 1;
    // Open by twice 30 degrees about a hinge 10 mm behind: closed, the tips are so much farther from it.
    first.shaft = {0.5, 0, std::sqrt(0.75)};
    second.shaft = {-0.5, 0, std::sqrt(0.75)};
    const TickResult joined = joined_jaws(first, second, 10);
    const double farther = 10 * (1 - std::sqrt(0.75));
    EXPECT_NEAR((vector_of(joined.device_position) - Vector3d(2, 2, 4 - farther)).norm(), 0, 1e-12);
    EXPECT_NEAR((vector_of(joined.tool_position) - Vector3d(1, 0, -farther)).norm(), 0, 1e-12);
    EXPECT_EQ(joined.buttons, 0U);
    EXPECT_EQ(joined.force, (std::array<double, 3>{0, 0.5, 0}));
    EXPECT_EQ(joined.depth, 2);
    EXPECT_EQ(joined.body, 4);
    EXPECT_EQ(joined.status, contact_unsettled);
    EXPECT_EQ(joined.contact_count, static_cast<int>(max_contacts));
    EXPECT_EQ(joined.contacts[39].triangle, 5);
    EXPECT_EQ(joined.contacts[40].triangle, 7);
}

}  // namespace
}  // namespace palpate
