// SPDX-License-Identifier: Apache-2.0
#include <Eigen/LU>
#include <array>
#include <atomic>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <thread>
#include <vector>

#include "runtime/haptics/collision_loop.hpp"
#include "runtime/haptics/methods/published_contact.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/elastic_cube.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;

constexpr double stiffness = 0.4;       // N/mm, of the sample's coupling
constexpr double float_error = 1e-5;    // relative: contacts and compliances are float32
constexpr double surface_error = 1e-6;  // mm: vertices are rounded to float32

// A case with its surfaces, and the published contact on it.
class Published {
  public:
    Published(Case patient_case, std::string_view scheme)
        : case_(std::move(patient_case)),
          bodies_(case_, false),
          contact_(
              case_, bodies_,
              scheme.starts_with("twice") ? PublishedContact::Tested::twice
                                          : PublishedContact::Tested::single,
              scheme.ends_with("renewed") ? PublishedContact::Face::renewed : PublishedContact::Face::kept) {}

    Vector3d tick(const Vector3d& device) noexcept {
        result_ = TickResult{};
        return contact_.tick(device, stiffness, result_);
    }
    // The collision loop comes by while the device is there.
    void detect_at(const Vector3d& device) noexcept {
        tick(device);
        contact_.detect();
    }
    PublishedContact& contact() noexcept { return contact_; }
    const TickResult& result() const noexcept { return result_; }

  private:
    Case case_;
    ContactBodies bodies_;
    PublishedContact contact_;
    TickResult result_;
};

// A rigid plate, 20 mm wide and 2 mm thick; its faces are at z = 0 and z = 2.
Case published_plate() {
    Case c = sample::sample_case();
    RigidBody& body = c.rigid_bodies.front();
    body.surface = boundary_surface(sample::cube_mesh(2, 20)).surface;
    for (Vector3d& vertex : body.surface.vertices) vertex.z() *= 0.1;
    body.obb_tree = sample::median_tree(body.surface, 4);
    c.deformable_bodies.clear();
    return c;
}

// An elastic cube of 20 mm, held at z = 0.
Case published_cube() {
    Case c = sample::sample_case();
    c.rigid_bodies.clear();
    c.deformable_bodies = {sample::true_elastic_cube(3)};
    return c;
}

const Vector3d above{7, 9, 6};  // over the plate

Vector3d height(double z) {
    return {above.x(), above.y(), z};
}

TEST(PublishedContact, is_a_spring_from_the_anchor_to_the_device) {
    for (const std::string_view scheme : {"single", "twice"}) {
        Published plate_contact(published_plate(), scheme);
        plate_contact.detect_at(height(1.5));
        const Vector3d force = plate_contact.tick({7.25, 9, 1.25});
        const Vector3d expected = stiffness * Vector3d(-0.25, 0, 0.75);
        EXPECT_NEAR((force - expected).norm(), 0, stiffness * surface_error);
        const TickResult& result = plate_contact.result();
        ASSERT_EQ(result.contact_count, 1);
        EXPECT_NEAR(result.contacts[0].force, expected.norm(), float_error);
        EXPECT_NEAR(result.depth, 0.75, float_error);
        EXPECT_EQ(result.body, 0);
    }
}

TEST(PublishedContact, single_feels_nothing_until_a_detection_found_the_point_inside) {
    Published plate_contact(published_plate(), "single");
    plate_contact.detect_at(above);
    for (const double z : {1.9, 1.5, 1.2}) EXPECT_EQ(plate_contact.tick(height(z)), Vector3d::Zero());
    plate_contact.detect_at(height(1.2));
    EXPECT_NEAR(plate_contact.tick(height(1.2)).z(), stiffness * 0.8, stiffness * surface_error);
}

TEST(PublishedContact, twice_feels_a_puncture_one_tick_after_the_point_was_inside) {
    Published plate_contact(published_plate(), "twice");
    plate_contact.detect_at(above);
    EXPECT_EQ(plate_contact.tick(height(2.1)), Vector3d::Zero());
    EXPECT_EQ(plate_contact.tick(height(1.9)), Vector3d::Zero());
    EXPECT_NEAR(plate_contact.tick(height(1.7)).z(), stiffness * 0.3, stiffness * surface_error);
}

TEST(PublishedContact, a_plate_passed_between_two_detections_is_noticed_by_twice_alone) {
    const auto pass = [](std::string_view scheme) {
        Published plate_contact(published_plate(), scheme);
        plate_contact.detect_at(height(3));
        std::vector<double> forces;
        for (double z = 3; z > -1; z -= 0.145) forces.push_back(plate_contact.tick(height(z)).z());
        return forces;
    };
    for (const double force : pass("single")) EXPECT_EQ(force, 0);
    const std::vector<double> held = pass("twice");
    EXPECT_EQ(std::ranges::min(held), 0);  // never pushed on
    // The flag stays on behind the plate, since the tip still goes against the normal.
    EXPECT_NEAR(held.back(), stiffness * (2 - (3 - 0.145 * static_cast<double>(held.size() - 1))), 1e-6);
}

TEST(PublishedContact, twice_lets_go_as_soon_as_the_tip_turns_back_or_rests) {
    Published plate_contact(published_plate(), "twice");
    plate_contact.detect_at(height(3));
    for (const double z : {1.9, 1.8}) plate_contact.tick(height(z));
    ASSERT_GT(plate_contact.tick(height(1.6)).z(), 0);
    EXPECT_EQ(plate_contact.tick(height(1.6)), Vector3d::Zero());
    ASSERT_GT(plate_contact.tick(height(1.5)).z(), 0);
    EXPECT_EQ(plate_contact.tick(height(1.6)), Vector3d::Zero());
}

TEST(PublishedContact, a_tip_that_left_between_two_detections_is_pulled_back_by_single_alone) {
    for (const std::string_view scheme : {"single", "twice"}) {
        Published plate_contact(published_plate(), scheme);
        plate_contact.detect_at(height(1.5));
        ASSERT_GT(plate_contact.tick(height(1.9)).z(), 0);
        const Vector3d force = plate_contact.tick(height(3));
        EXPECT_NEAR(force.z(), scheme == "single" ? -stiffness : 0, stiffness * surface_error);
    }
}

TEST(PublishedContact, reset_forgets_the_last_detection_and_position) {
    Published plate_contact(published_plate(), "twice");
    plate_contact.detect_at(height(1.5));
    ASSERT_GT(plate_contact.tick(height(1.5)).norm(), 0);
    plate_contact.contact().reset();
    plate_contact.contact().detect();  // of no position
    EXPECT_EQ(plate_contact.tick(height(1.4)), Vector3d::Zero());
}

constexpr std::array all_schemes{"single", "twice", "single-renewed", "twice-renewed"};

TEST(PublishedContact, an_answer_to_what_was_asked_before_a_loss_never_counts) {
    for (const std::string_view scheme : all_schemes) {
        Published plate_contact(published_plate(), scheme);
        plate_contact.tick(height(1.5));
        const PublishedContact::Asked asked = plate_contact.contact().asked();
        plate_contact.contact().lose();
        plate_contact.contact().answer(asked);  // was on its way
        EXPECT_EQ(plate_contact.tick(height(1.5)), Vector3d::Zero());
        EXPECT_EQ(plate_contact.result().detected_tick, -1);
        plate_contact.contact().answer(asked);  // or comes later still
        EXPECT_EQ(plate_contact.tick(height(1.5)), Vector3d::Zero());
        plate_contact.contact().detect();
        EXPECT_NEAR(plate_contact.tick(height(1.5)).z(), stiffness * 0.5, stiffness * surface_error);
    }
}

TEST(PublishedContact, a_given_detection_counts_in_the_first_tick_after_a_loss) {
    Published plate_contact(published_plate(), "twice");
    plate_contact.detect_at(height(1.5));
    plate_contact.contact().lose();
    plate_contact.contact().detect();  // of no position
    EXPECT_EQ(plate_contact.tick(height(1.5)), Vector3d::Zero());
    plate_contact.contact().lose();
    plate_contact.contact().detect_at({above.x(), above.y(), 1.5}, 3);
    EXPECT_NEAR(plate_contact.tick(height(1.5)).z(), stiffness * 0.5, stiffness * surface_error);
    EXPECT_EQ(plate_contact.result().detected_tick, 3);
}

TEST(PublishedContact, a_tip_pressed_past_the_middle_of_a_wall_stays_with_the_face_it_came_through) {
    for (const std::string_view scheme : all_schemes) {
        Published plate_contact(published_plate(), scheme);
        plate_contact.detect_at(height(1.5));
        plate_contact.detect_at(height(0.5));  // nearer to the far side
        const bool renewed = scheme.ends_with("renewed");
        EXPECT_NEAR(plate_contact.tick(height(0.5)).z(), stiffness * (renewed ? -0.5 : 1.5),
                    stiffness * surface_error)
            << scheme;
    }
}

TEST(PublishedContact, a_kept_face_is_left_for_one_beside_it) {
    // From the top over the edge at x = 20 to the side.
    Published plate_contact(published_plate(), "twice");
    plate_contact.detect_at({19, 9, 1.8});
    plate_contact.detect_at({19.9, 9, 1.2});
    const Vector3d force = plate_contact.tick({19.9, 9, 1.2});
    EXPECT_NEAR((force - stiffness * Vector3d(0.1, 0, 0)).norm(), 0, stiffness * surface_error);
}

TEST(PublishedContact, a_face_is_kept_for_as_long_as_there_is_force) {
    Published plate_contact(published_plate(), "twice");
    plate_contact.detect_at(height(1.5));
    plate_contact.detect_at(height(3));  // lets go
    plate_contact.detect_at(height(0.5));
    EXPECT_NEAR(plate_contact.tick(height(0.5)).z(), -stiffness * 0.5, stiffness * surface_error);
}

TEST(PublishedContact, behind_a_wall_twice_goes_by_the_face_it_came_through) {
    for (const std::string_view scheme : {"twice", "twice-renewed"}) {
        Published plate_contact(published_plate(), scheme);
        plate_contact.detect_at(height(1.5));
        plate_contact.tick(height(-0.2));
        plate_contact.contact().detect();  // outside, nearest to the far side
        // Still inwards, so the flag stays; outwards by the far side's normal, so it goes.
        EXPECT_NEAR(plate_contact.tick(height(-0.3)).z(), scheme == "twice" ? stiffness * 2.3 : 0,
                    stiffness * surface_error);
        EXPECT_EQ(plate_contact.tick(height(-0.3)), Vector3d::Zero());
    }
}

TEST(PublishedContact, a_point_found_in_the_far_half_of_a_wall_is_led_through) {
    for (const std::string_view scheme : all_schemes) {
        Published plate_contact(published_plate(), scheme);
        plate_contact.detect_at(height(0.5));
        EXPECT_NEAR(plate_contact.tick(height(0.5)).z(), -stiffness * 0.5, stiffness * surface_error);
    }
}

TEST(ImposeDisplacement, nodal_forces_displace_the_polygon_as_imposed) {
    const DeformableBody body = sample::true_elastic_cube(3);
    const Vector3d u(0.3, -0.2, -0.7);
    const std::array<std::int32_t, 3> blocks{3, 11, 20};
    const auto forces = impose_displacement(body.compliance, blocks, u);
    for (const std::int32_t a : blocks) {
        Vector3d displaced = Vector3d::Zero();
        for (std::size_t b = 0; b < 3; ++b)
            displaced += compliance_block(body.compliance, a, blocks[b]).cast<double>() * forces[b];
        EXPECT_NEAR((displaced - u).norm(), 0, float_error * u.norm());
    }
    // A fixed vertex gets no force, and the others are displaced all the same.
    const auto [f_P, f_Q, f_R] = impose_displacement(body.compliance, {3, -1, 20}, u);
    EXPECT_EQ(f_Q, Vector3d::Zero());
    const Vector3d at_P = compliance_block(body.compliance, 3, 3).cast<double>() * f_P +
                          compliance_block(body.compliance, 3, 20).cast<double>() * f_R;
    EXPECT_NEAR((at_P - u).norm(), 0, float_error * u.norm());
    for (const Vector3d& f : impose_displacement(body.compliance, {-1, -1, -1}, u))
        EXPECT_EQ(f, Vector3d::Zero());
}

TEST(PublishedContact, an_elastic_body_answers_with_what_moves_its_polygon_to_the_tip) {
    const Case c = published_cube();
    const DeformableBody& body = c.deformable_bodies.front();
    Published cube(c, "twice");
    const Vector3d tip(8, 5, 18.5);
    cube.detect_at(tip);
    const Vector3d force = cube.tick(tip);
    ASSERT_EQ(cube.result().contact_count, 1);
    const Contact& contact = cube.result().contacts[0];

    // By hand: the inverse of C_cc times (0, 0, -1.5) thrice, nodal forces summed, turned round.
    Eigen::Matrix<double, 9, 9> C;
    std::array<std::int32_t, 3> blocks{};
    for (std::size_t v = 0; v < 3; ++v)
        blocks[v] = static_cast<std::int32_t>(
            std::ranges::lower_bound(body.contact_nodes,
                                     body.boundary.nodes[static_cast<std::size_t>(contact.vertices[v])]) -
            body.contact_nodes.begin());
    for (std::size_t i = 0; i < 3; ++i)
        for (std::size_t j = 0; j < 3; ++j)
            C.block<3, 3>(static_cast<Eigen::Index>(3 * i), static_cast<Eigen::Index>(3 * j)) =
                compliance_block(body.compliance, blocks[i], blocks[j]).cast<double>();
    const Eigen::Matrix<double, 9, 1> f = C.inverse() * Vector3d(0, 0, -1.5).replicate<3, 1>();
    const Vector3d expected = -(f.segment<3>(0) + f.segment<3>(3) + f.segment<3>(6));
    EXPECT_NEAR((force - expected).norm(), 0, float_error * expected.norm());
    EXPECT_GT(force.z(), 0);

    EXPECT_NEAR(contact.force, force.norm(), float_error * force.norm());
    EXPECT_NEAR(Eigen::Map<const Eigen::Vector3f>(contact.weights.data()).sum(), 1, float_error);
    EXPECT_NEAR(contact.gap, 1.5, float_error);
}

TEST(PublishedContact, force_of_an_elastic_body_grows_with_depth_between_detections) {
    Published cube(published_cube(), "single");
    cube.detect_at({8, 5, 19.5});
    const double shallow = cube.tick({8, 5, 19.5}).norm();
    EXPECT_NEAR(cube.tick({8, 5, 18}).norm(), 4 * shallow, float_error);
    EXPECT_NEAR(cube.tick({9, 6, 19.5}).norm(), shallow, float_error);  // F is the foot on the plane
}

TEST(PublishedContact, a_polygon_of_fixed_vertices_is_rigid) {
    Published cube(published_cube(), "twice");
    cube.detect_at({8, 5, 0.5});
    EXPECT_NEAR((cube.tick({8, 5, 0.5}) - Vector3d(0, 0, -0.5 * stiffness)).norm(), 0, 1e-6);
}

TEST(PublishedContact, a_tick_never_allocates) {
    Case c = published_cube();
    c.rigid_bodies = sample::sample_case().rigid_bodies;
    Published both(c, "twice");
    int touching = 0;
    std::size_t allocated = 0;
    for (int tick = 0; tick < 20000; ++tick) {
        const double t = 1e-3 * tick;
        const Vector3d device(20 + 18 * std::sin(1.1 * t), 10 + 9 * std::sin(2.3 * t + 1),
                              19 + 7 * std::cos(5.1 * t));
        {
            const AllocationTrap trap;
            both.tick(device);
            allocated += trap.count();
        }
        touching += both.result().contact_count > 0;
        if (tick % 33 == 0) both.contact().detect();
    }
    EXPECT_EQ(allocated, 0U);
    EXPECT_GT(touching, 2000);
}

TEST(PublishedContact, detections_of_a_second_thread_reach_the_servo) {
    Published plate_contact(published_plate(), "single");
    plate_contact.tick(height(1.5));
    CollisionLoop loop([&]() noexcept { plate_contact.contact().detect(); },
                       CollisionLoop::published_period_ns);
    loop.start();
    double force = 0;
    for (int tick = 0; tick < 2000 && force == 0; ++tick) {
        force = plate_contact.tick(height(1.5)).z();
        std::this_thread::sleep_for(std::chrono::milliseconds(1));
    }
    loop.stop();
    EXPECT_NEAR(force, stiffness * 0.5, stiffness * surface_error);
}

TEST(CollisionLoop, detects_until_it_is_stopped) {
    std::atomic<int> calls = 0;
    CollisionLoop loop([&] { ++calls; }, CollisionLoop::published_period_ns);
    loop.start();
    while (calls < 2) std::this_thread::yield();
    loop.stop();
    const int counted = calls;
    std::this_thread::sleep_for(std::chrono::nanoseconds(2 * CollisionLoop::published_period_ns));
    EXPECT_EQ(calls, counted);
}

}  // namespace
}  // namespace palpate
