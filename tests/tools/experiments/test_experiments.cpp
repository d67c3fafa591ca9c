// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>
#include <limits>

#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tools/experiments/fault_run.hpp"
#include "tools/experiments/puncture/approach_run.hpp"
#include "tools/experiments/puncture/approaches.hpp"
#include "tools/experiments/puncture/many_approaches.hpp"
#include "tools/experiments/puncture/synchroniser.hpp"
#include "tools/experiments/puncture/wall_map.hpp"
#include "tools/experiments/rigid_case.hpp"
#include "tools/experiments/stability/wall_stability.hpp"
#include "tools/experiments/statistics.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using namespace experiments;
using Eigen::Vector3d;

constexpr HandImpedance no_hand{.stiffness = 0, .damping = 0};

WallLoop plain_loop(int refresh_ticks) {
    return {.model = {.name = "plain",
                      .mass_kg = 0.045,
                      .damping = 5e-4,
                      .max_force = std::numeric_limits<double>::infinity()},
            .hand = no_hand,
            .refresh_ticks = refresh_ticks};
}

// A hollow ball with a wall of that thickness.
TriangleMesh shell(double radius, double thickness) {
    TriangleMesh mesh = sample::sphere_surface(Vector3d::Zero(), radius, 4);
    const TriangleMesh inner = sample::sphere_surface(Vector3d::Zero(), radius - thickness, 4);
    const auto count = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), inner.vertices.begin(), inner.vertices.end());
    for (const Triangle& t : inner.triangles)
        mesh.triangles.push_back({t[0] + count, t[2] + count, t[1] + count});
    return mesh;
}

Approach onto_shell(double radius, double thickness, double speed) {
    // Off the vertices, against the facets' normal to a degree.
    const Vector3d outwards = Vector3d(0.2, 0.3, 0.9).normalized();
    return {.place = {.entry = radius * outwards, .direction = -outwards, .thickness = thickness},
            .speed = speed,
            .phase = 0.1};
}

TEST(ChanceInterval, agrees_with_published_values_of_clopper_and_pearson) {
    const auto near = [](Interval found, double lower, double upper) {
        EXPECT_NEAR(found.lower, lower, 5e-5);
        EXPECT_NEAR(found.upper, upper, 5e-5);
    };
    near(chance_interval(14, 100), 0.0787, 0.2237);
    near(chance_interval(4, 100), 0.0110, 0.0993);
}

TEST(ChanceInterval, of_no_success_ends_where_all_failing_has_a_chance_of_one_in_forty) {
    for (const int trials : {1, 10, 100, 10000}) {
        const Interval none = chance_interval(0, trials), all = chance_interval(trials, trials);
        EXPECT_EQ(none.lower, 0);
        EXPECT_NEAR(none.upper, 1 - std::pow(0.025, 1.0 / trials), 1e-8);
        EXPECT_NEAR(all.lower, std::pow(0.025, 1.0 / trials), 1e-8);
        EXPECT_EQ(all.upper, 1);
    }
}

TEST(Quantile, interpolates_between_sorted_values) {
    EXPECT_EQ(quantile({4, 1, 3, 2}, 0), 1);
    EXPECT_EQ(quantile({4, 1, 3, 2}, 1), 4);
    EXPECT_DOUBLE_EQ(quantile({4, 1, 3, 2}, 0.5), 2.5);
    EXPECT_TRUE(std::isnan(quantile({}, 0.5)));
}

// With e = exp(-T b / m) the sampled loop's determinant reaches 1 at
// K = b (1 - e) / (tau (1 - e)² - (T - tau (1 - e)) e), tau = m / b.
TEST(WallStability, the_eigenvalue_limit_is_that_of_the_hand_calculation) {
    for (const int ticks : {1, 33}) {
        const double b = 5e-4, tau = 4.5e-5 / b, T = 1e-3 * ticks, e = std::exp(-T / tau);
        const double expected = b * (1 - e) / (tau * (1 - e) * (1 - e) - (T - tau * (1 - e)) * e);
        EXPECT_NEAR(eigenvalue_limit(plain_loop(ticks)), expected, 5e-4 * expected) << ticks;
    }
}

TEST(WallStability, the_simulated_device_goes_unstable_where_the_eigenvalues_say) {
    constexpr double bisection = 2e-3;  // relative: twice 0.05 %, and growth over 1500 refreshes to be seen
    WallLoop delayed = plain_loop(1), held = plain_loop(1), slow = plain_loop(33);
    delayed.model.delay_ticks = 1;
    held.hand = {};
    for (const WallLoop& loop : {plain_loop(1), delayed, held, slow}) {
        const double expected = eigenvalue_limit(loop);
        EXPECT_NEAR(measured_limit(loop, spring_wall), expected, bisection * expected);
    }
}

TEST(WallStability, a_wall_without_damping_to_take_its_energy_is_never_stable) {
    WallLoop loop = plain_loop(1);
    loop.model.damping = 0;
    EXPECT_FALSE(try_wall(loop, 0.1, spring_wall(0.1)).stable);
    EXPECT_TRUE(try_wall(plain_loop(1), 0.1, spring_wall(0.1)).stable);
}

TEST(DrawPlaces, takes_the_outer_side_and_finds_the_thickness) {
    constexpr double radius = 40, thickness = 4, facets = 0.15;  // mm: sag of a facet
    const Case c = rigid_case("shell", shell(radius, thickness), {});
    const RigidBody& body = c.rigid_bodies[0];
    const collision::CollisionSurface surface(body.surface, body.obb_tree, body.name);
    std::mt19937_64 random(3);
    for (const Place& place : draw_places(body.surface, surface, 0.5, 50, random)) {
        EXPECT_NEAR(place.entry.norm(), radius, facets);
        EXPECT_GT(place.direction.dot(-place.entry.normalized()), 0.99);
        EXPECT_NEAR(place.thickness, thickness, 2 * facets);
    }
}

constexpr HapticSettings settings{
    .tool_radius = 0.5, .coupling_stiffness = 1, .max_force = 7.9, .max_force_rate = 7.9};

TEST(RunApproach, a_wall_thicker_than_the_way_between_detections_holds_with_every_scheme) {
    constexpr double radius = 40, thickness = 15;
    const Case c = rigid_case("shell", shell(radius, thickness), settings);
    for (const std::string_view scheme : {"single", "twice", "continuous"}) {
        haptics::HapticModel model(c, scheme);
        const Outcome outcome =
            run_approach(model, find_device_model("desktop"), onto_shell(radius, thickness, 145), false);
        EXPECT_FALSE(is_puncture(outcome, 1)) << scheme;
        EXPECT_FALSE(is_pulled(outcome));
        const double detection = scheme == "single" ? 1.0 / 30 : 0.002;
        EXPECT_LE(outcome.latency, detection + 0.001);
        EXPECT_LT(outcome.deepest, thickness / 2);
    }
}

TEST(RunApproach, continuous_contact_holds_on_a_thin_wall_and_single_detection_does_not) {
    constexpr double radius = 40, thickness = 1;
    const Case c = rigid_case("shell", shell(radius, thickness), settings);
    const DeviceModel& device = find_device_model("desktop");
    haptics::HapticModel continuous(c), single(c, "single");
    for (const double speed : {100.0, 700.0}) {
        const Approach approach = onto_shell(radius, thickness, speed);
        const Outcome held = run_approach(continuous, device, approach, true);
        EXPECT_FALSE(is_puncture(held, 1));
        EXPECT_FALSE(held.tool_in_surface || held.way_crossed);
        // The tool touches its radius earlier; the facets sag; friction bears part.
        const double friction = device.coulomb_friction, slack = 0.1;
        EXPECT_NEAR(held.held, unbroken_force(1) * 10.5 / 10, friction + slack);
        EXPECT_LE(held.latency, 0);
        EXPECT_NEAR(held.speed, speed, 0.35 * speed);  // the hand's spring swings
    }
    const Outcome lost = run_approach(single, device, onto_shell(radius, thickness, 700), false);
    EXPECT_TRUE(is_puncture(lost, 1));
    EXPECT_GT(lost.deepest, 9);
}

TEST(ManyApproaches, end_alike_however_many_threads_share_them) {
    const sample::Scratch scratch;
    meshing::write_surface(scratch / "shell.vtp", shell(40, 1));
    const auto run = [&](int threads) {
        cli::Session session{
            .threads = threads, .progress = cli::Progress(true), .shortfall = {}, .form = {}, .text = {}};
        Options options;
        options.surfaces = {scratch / "shell.vtp"};
        options.approaches = 20;
        return many_approaches(options, session).result;
    };
    const auto one = run(1), surface = one["surfaces"][0];
    EXPECT_EQ(surface["approaches"], 20);
    EXPECT_EQ(surface["tool_in_surface"], 0);
    EXPECT_EQ(surface["punctures"], 0);
    EXPECT_GT(surface["tip_speed_max_mm_s"], 500);
    EXPECT_EQ(run(3), one);
}

// Up to its first force the hand goes the same way, so one more turn of the loop is all that is between them.
TEST(Synchroniser, late_answers_put_the_first_force_off_by_one_turn_of_the_loop) {
    constexpr double turn = 1.0 / 30, tick = 0.001;
    const Case c = rigid_case("plate", plate_surface(), settings);
    haptics::HapticModel model(c, "single");
    const TouchPoint place{
        .point = {7, 19, 0}, .normal = Vector3d::UnitZ(), .tangent = Vector3d::UnitX(), .clearance = 60};
    const HandPath path = press_path(place, {.tool_radius = 0, .depth = 4, .speed = 40, .seconds = 1});
    for (const double phase : {0.1, 0.45, 0.8}) {
        const auto touch = [&](Crossing crossing) {
            return touch_published(model, find_device_model("desktop"), path, place.normal, phase, crossing);
        };
        const TouchFigures before = touch(Crossing::late), after = touch(Crossing::synchronised);
        ASSERT_GT(after.first_force_s, 0);
        EXPECT_NEAR(before.first_force_s - after.first_force_s, turn, tick);
        EXPECT_GT(before.largest_step, after.largest_step);  // it begins deeper
        EXPECT_GT(before.pull, after.pull);                  // and ends farther out
    }
}

// At rest the tip is 10 * 0.3 / 1.3 = 2.3 mm deep: past the middle of 4 mm, not of 6.
TEST(WallMap, a_renewed_face_is_lost_where_the_hand_presses_past_the_middle_and_a_kept_one_is_not) {
    const DeviceModel& device = find_device_model("desktop");
    EXPECT_EQ(punctures_of_wall("twice-renewed", device, 4, 0.3), 100);
    EXPECT_EQ(punctures_of_wall("twice", device, 4, 0.3), 0);
    EXPECT_EQ(punctures_of_wall("twice", device, 1, 0.3), 100);  // past the whole of it
    EXPECT_EQ(punctures_of_wall("continuous", device, 1, 0.3), 0);
}

TEST(WallMap, a_count_lies_where_the_thickest_wall_above_it_ends) {
    std::array<int, walls.size()> counts{100, 100, 20, 10};
    EXPECT_DOUBLE_EQ(wall_at(counts, 14), 3.6);
    EXPECT_DOUBLE_EQ(wall_at(counts, 60), 2.5);
    counts.fill(50);
    EXPECT_TRUE(std::isnan(wall_at(counts, 14)));
}

TEST(FaultRun, five_virtual_minutes_keep_to_every_limit_and_report_every_fault_once) {
    constexpr std::int64_t ticks = 300'000;
    std::mt19937_64 random(7);
    for (const std::string_view scheme : {"continuous", "twice"}) {
        const std::vector<Injection> injections = draw_injections(ticks, random);
        const FaultRun run = run_with_faults(sample::sample_case(), scheme, find_device_model("touch"),
                                             injections, ticks, random);
        EXPECT_EQ(run.ticks, ticks);
        EXPECT_GT(run.pressing, ticks / 10);
        EXPECT_EQ(run.reported, static_cast<std::int64_t>(injections.size()));
        EXPECT_GT(run.reported, 15);
        EXPECT_EQ(run.missed + run.unexpected, 0);
        EXPECT_EQ(run.above_limit + run.above_slew + run.not_finite + run.not_gone, 0);
        EXPECT_LE(run.largest_growth, sample::sample_case().haptics.max_force / 100 + 1e-9);
    }
}

TEST(FaultRun, a_fault_that_nobody_reports_is_missed) {
    std::mt19937_64 random(7);
    // The force is a number here, so no tick tells of it.
    const FaultRun run = run_with_faults(sample::sample_case(), "continuous", find_device_model("touch"),
                                         {{invalid_force, 100, 200}}, 1000, random);
    EXPECT_EQ(run.missed, 1);
    EXPECT_EQ(run.reported, 0);
}

}  // namespace
}  // namespace palpate::experiments
