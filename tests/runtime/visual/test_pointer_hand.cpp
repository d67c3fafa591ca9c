// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>
#include <vector>

#include "runtime/visual/hand/pointer_hand.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate {
namespace {

using namespace visual;
using collision::CollisionSurface;
using Eigen::Vector2d;
using Eigen::Vector3d;

constexpr double tool_radius = 1;  // mm, of the tool
constexpr double frame_s = 1e-2;   // s
constexpr double fastest = 150;    // mm/s

// A ball of 20 mm about the origin, looked at from above; a pixel is a tenth of a millimetre.
class PointerHandTest : public testing::Test {
  protected:
    PointerHandTest() : mesh_(sample::sphere_surface(Vector3d::Zero(), 20, 4)) {
        surfaces_.emplace_back(mesh_, sample::median_tree(mesh_, 4), "ball");
    }

    static Vector2d pixel_over(double x, double y) { return {10 * x, 10 * y}; }

    std::vector<const CollisionSurface*> surfaces() const {
        std::vector<const CollisionSurface*> all;
        for (const CollisionSurface& surface : surfaces_) all.push_back(&surface);
        return all;
    }

    PointerScene scene() const {
        return {
            .under =
                [this](const Vector2d& pixel) {
                    const Vector3d p(pixel[0] / 10, pixel[1] / 10, 0);
                    return surface_under(surfaces(), p + Vector3d(0, 0, 100), p - Vector3d(0, 0, 100),
                                         tool_radius);
                },
            .blocked = [this](const Vector3d& from,
                              const Vector3d& to) { return is_blocked(surfaces(), from, to, tool_radius); }};
    }

    // Frames until nothing moves for long; the tool's places on the way.
    std::vector<Vector3d> settle(PointerHand& hand) {
        std::vector<Vector3d> places{hand.place()};
        for (int frame = 0; frame < 2000; ++frame) {
            hand.advance(frame_s, scene());
            places.push_back(hand.place());
        }
        return places;
    }

    TriangleMesh mesh_;
    std::vector<CollisionSurface> surfaces_;
};

// What a ball of triangles misses of a round one, and the tilt of its mean normals.
constexpr double facets = 0.15;  // mm

TEST_F(PointerHandTest, hovers_over_the_surface_under_the_pointer) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(6, 0));
    settle(hand);
    EXPECT_NEAR(hand.place().norm(), 20 + tool_radius + PointerHand::hover, facets);
    EXPECT_NEAR(hand.place().x() / hand.place().norm(), 6.0 / 20, 0.02);
}

TEST_F(PointerHandTest, looks_for_a_force_that_is_not_there_no_farther_than_three_times_as_deep) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.feel(0, 1.0);
    hand.point(pixel_over(3, 2));
    hand.press(true);
    hand.advance(0.5, scene());  // a picture that comes late
    EXPECT_GT(hand.place().norm(), 20 + tool_radius) << "does not make it fall in";
    settle(hand);
    EXPECT_NEAR(hand.place().norm(), 20 + tool_radius - 3 * hand.depth(), facets);
}

TEST_F(PointerHandTest, goes_no_deeper_by_itself_once_the_wheel_has_turned) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.feel(0, 1.0);
    hand.point(pixel_over(3, 2));
    settle(hand);
    hand.press(true);
    for (int frame = 0; frame < 30; ++frame) hand.advance(frame_s, scene());  // on its way
    const double deep = 20 + tool_radius - hand.place().norm();
    ASSERT_GT(deep, PointerHand::least_depth);
    hand.deepen(1);
    settle(hand);
    EXPECT_NEAR(20 + tool_radius - hand.place().norm(), deep + 1, facets);
}

TEST_F(PointerHandTest, stays_where_no_way_leads_around) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(-15, 0));
    settle(hand);
    const Vector3d before = hand.place();
    PointerScene walled = scene();
    walled.blocked = [](const Vector3d&, const Vector3d&) { return true; };
    hand.view_changed();
    hand.point(pixel_over(15, 0));
    for (int frame = 0; frame < 500; ++frame) hand.advance(frame_s, walled);
    EXPECT_LT((hand.place() - before).norm(), facets);
}

// On tissue of 0.1 N/mm whose force a hand sees three frames late.
TEST_F(PointerHandTest, sinks_until_it_feels_what_is_wanted_and_keeps_that_depth) {
    constexpr double stiffness = 0.1, wanted = 0.25;  // N/mm, N
    PointerHand hand({0, 0, 60}, tool_radius);
    std::vector<double> forces(3, 0.0);
    const auto press = [&](int frames) {
        double most = 0;
        for (int frame = 0; frame < frames; ++frame) {
            hand.feel(forces[forces.size() - 3], wanted);
            hand.advance(frame_s, scene());
            forces.push_back(stiffness * std::max(0.0, 20 + tool_radius - hand.place().norm()));
            most = std::max(most, forces.back());
        }
        return most;
    };
    hand.point(pixel_over(3, 2));
    hand.press(true);
    EXPECT_LT(press(1000), 1.2 * wanted);
    EXPECT_GE(forces.back(), wanted - stiffness * facets);
    hand.deepen(1);
    press(100);
    EXPECT_NEAR(forces.back(), wanted + stiffness * 1, 0.1 * wanted + stiffness * facets);
    hand.press(false);
    press(100);
    hand.press(true);
    EXPECT_LT(press(1000), 1.2 * wanted) << "the next press feels its way in anew";
}

TEST_F(PointerHandTest, sinks_to_its_depth_while_pressed_and_rises_when_released) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(3, 2));
    hand.press(true);
    settle(hand);
    EXPECT_NEAR(hand.place().norm(), 20 + tool_radius - hand.depth(), facets);
    hand.deepen(2);
    settle(hand);
    EXPECT_NEAR(hand.place().norm(), 20 + tool_radius - 5, facets);
    hand.press(false);
    settle(hand);
    EXPECT_NEAR(hand.place().norm(), 20 + tool_radius + PointerHand::hover, facets);
}

TEST_F(PointerHandTest, slides_at_its_depth_where_it_is_dragged) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(-8, 0));
    hand.press(true);
    settle(hand);
    hand.point(pixel_over(8, 3));
    for (const Vector3d& place : settle(hand))
        EXPECT_NEAR(place.norm(), 20 + tool_radius - hand.depth(), facets);
    EXPECT_GT(hand.place().x(), 5);
}

TEST_F(PointerHandTest, is_never_faster_than_a_hand) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(-15, -5));
    std::vector<Vector3d> places = settle(hand);
    hand.press(true);
    hand.point(pixel_over(12, 5));
    for (const Vector3d& place : settle(hand)) places.push_back(place);
    for (std::size_t i = 1; i < places.size(); ++i)
        EXPECT_LE((places[i] - places[i - 1]).norm(), fastest * frame_s + 0.5);  // and it sinks meanwhile
}

TEST_F(PointerHandTest, goes_around_what_stands_between_two_places) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(-19, 0));
    settle(hand);
    hand.view_changed();
    hand.point(pixel_over(19, 0));
    for (const Vector3d& place : settle(hand)) EXPECT_GT(place.norm(), 20 + 0.5 * tool_radius);
    EXPECT_GT(hand.place().x(), 15);
}

TEST_F(PointerHandTest, stays_where_it_is_when_the_pointer_leaves_the_body) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(5, 0));
    settle(hand);
    const Vector3d before = hand.place();
    hand.view_changed();
    hand.point(pixel_over(90, 0));
    settle(hand);
    EXPECT_EQ(hand.place(), before);
}

TEST_F(PointerHandTest, a_button_pressed_beside_every_body_presses_nothing) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(5, 0));
    settle(hand);
    hand.point(pixel_over(90, 0));
    hand.press(true);
    for (const Vector3d& place : settle(hand))
        EXPECT_NEAR(place.norm(), 20 + tool_radius + PointerHand::hover, facets);
}

TEST_F(PointerHandTest, goes_behind_an_edge_only_where_the_pointer_rests) {
    const TriangleMesh behind = sample::sphere_surface({45, 0, -30}, 20, 4);
    surfaces_.emplace_back(behind, sample::median_tree(behind, 4), "ball behind");
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(0, 0));
    hand.press(true);
    settle(hand);
    for (int x = 0; x <= 45; ++x) {  // a pixel step a frame, without a rest
        hand.point(pixel_over(x, 0));
        hand.advance(frame_s, scene());
    }
    EXPECT_LT(hand.place().x(), 21);
    EXPECT_GT(hand.place().z(), -5);
    settle(hand);
    EXPECT_NEAR((hand.place() - Vector3d(45, 0, -30)).norm(), 20 + tool_radius - hand.depth(), facets);
}

TEST_F(PointerHandTest, a_new_view_lets_it_rise_but_takes_it_nowhere) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(5, 0));
    hand.press(true);
    settle(hand);
    hand.point(pixel_over(-5, 0));
    hand.press(false);
    hand.view_changed();
    settle(hand);
    EXPECT_NEAR(hand.place().norm(), 20 + tool_radius + PointerHand::hover, facets);
    EXPECT_GT(hand.place().x(), 4);
}

TEST_F(PointerHandTest, keys_take_it_off_the_surface_until_the_pointer_moves) {
    PointerHand hand({0, 0, 60}, tool_radius);
    hand.point(pixel_over(5, 0));
    settle(hand);
    const Vector3d before = hand.place();
    hand.move({0, 0, 4});
    settle(hand);
    EXPECT_EQ(hand.place(), Vector3d(before + Vector3d(0, 0, 4)));
    hand.point(pixel_over(5, 1));
    settle(hand);
    EXPECT_NEAR(hand.place().norm(), 20 + tool_radius + PointerHand::hover, facets);
}

TEST_F(PointerHandTest, a_line_of_sight_that_begins_in_a_body_meets_nothing) {
    const auto all = surfaces();
    EXPECT_FALSE(surface_under(all, Vector3d::Zero(), {0, 0, -100}, tool_radius));
    EXPECT_TRUE(surface_under(all, {0, 0, 100}, {0, 0, -100}, tool_radius));
    EXPECT_FALSE(surface_under(all, {0, 0, 100}, {0, 0, 50}, tool_radius));
}

TEST_F(PointerHandTest, the_nearest_of_several_bodies_is_under_the_pointer) {
    const TriangleMesh small = sample::sphere_surface({0, 0, 40}, 5, 3);
    surfaces_.emplace_back(small, sample::median_tree(small, 4), "small ball");
    const auto seen = surface_under(surfaces(), {0, 0, 100}, {0, 0, -100}, tool_radius);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->point.z(), 45, facets);
    EXPECT_NEAR(seen->normal.z(), 1, 0.01);
}

TEST_F(PointerHandTest, a_line_of_sight_goes_on_through_insides_that_are_not_drawn) {
    const TriangleMesh small = sample::sphere_surface({0, 0, 40}, 5, 3);
    surfaces_.emplace_back(small, sample::median_tree(small, 4), "small ball");
    const auto all = surfaces();
    EXPECT_FALSE(surface_under(all, Vector3d::Zero(), {0, 0, 100}, tool_radius));
    const auto seen = surface_under(all, Vector3d::Zero(), {0, 0, 100}, tool_radius, false);
    ASSERT_TRUE(seen);
    EXPECT_NEAR(seen->point.z(), 35, facets);
    EXPECT_NEAR(seen->seen_from.z(), 20, facets);
    EXPECT_FALSE(surface_under(all, Vector3d::Zero(), {0, 0, -100}, tool_radius, false));
}

}  // namespace
}  // namespace palpate
