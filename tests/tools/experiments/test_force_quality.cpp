// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <numbers>
#include <random>

#include "tests/formats/sample_case.hpp"
#include "tools/experiments/force_quality.hpp"

namespace palpate::experiments {
namespace {

using namespace experiments;
using Eigen::Vector3d;

constexpr double stiffness = 0.4;   // N/mm
constexpr double rounding = 1e-12;  // of sums of a thousand terms
constexpr double float_error = 1e-6;

// The elastic cube [0, 20]³ alone.
Case cube() {
    Case c;
    c.deformable_bodies = {sample::elastic_cube(2)};
    return c;
}

// A contact at the middle of those vertices of one of the cube's triangles that `holds` takes.
template <typename Predicate>
Contact contact_at(const Case& c, std::size_t count, Predicate holds, const Vector3d& normal, double force) {
    const TriangleMesh& surface = c.deformable_bodies.front().boundary.surface;
    Contact contact;
    for (const Triangle& t : surface.triangles) {
        std::size_t found = 0;
        for (const std::int32_t v : t)
            if (holds(surface.vertices[static_cast<std::size_t>(v)])) {
                contact.vertices[found] = v;
                contact.weights[found++] = 1 / static_cast<float>(count);
            }
        if (found == count) break;
        contact = Contact{};
    }
    Eigen::Map<Eigen::Vector3f>(contact.normal.data()) = normal.cast<float>();
    contact.force = static_cast<float>(force);
    return contact;
}

bool on_top(const Vector3d& p) {
    return p.z() == 20;
}
bool on_top_edge(const Vector3d& p) {
    return p.z() == 20 && p.x() == 20;
}

// What a measurement refers to.
struct Setting {
    Case patient_case = cube();
    RestNormals normals{patient_case};
    haptics::HapticModel model{patient_case};
    ForceQuality quality(double grain = 0) const { return {normals, model, {stiffness, grain}}; }
};

TickResult with_force(double force) {
    TickResult result{};
    result.force = {force, 0, 0};
    return result;
}

TEST(RestNormals, a_pull_is_what_goes_against_the_surface) {
    const Case c = cube();
    const RestNormals normals(c);
    EXPECT_NEAR(normals.pull(contact_at(c, 3, on_top, {0, 0, -1}, 0.3)), 0.3, float_error);
    EXPECT_NEAR(normals.pull(contact_at(c, 3, on_top, Vector3d(4, 0, -3) / 5, 0.5)), 0.3, float_error);
    EXPECT_EQ(normals.pull(contact_at(c, 3, on_top, {0, 0, 1}, 0.3)), 0);
    EXPECT_EQ(normals.pull(contact_at(c, 3, on_top, {1, 0, 0}, 0.3)), 0);
}

TEST(RestNormals, at_an_edge_a_force_pulls_only_if_it_is_against_both_faces) {
    const Case c = cube();
    const RestNormals normals(c);
    EXPECT_EQ(normals.pull(contact_at(c, 2, on_top_edge, Vector3d(4, 0, -3) / 5, 1)), 0);
    EXPECT_NEAR(normals.pull(contact_at(c, 2, on_top_edge, Vector3d(-4, 0, -3) / 5, 1)), 0.6, float_error);
}

TEST(ForceQuality, counts_jumps_and_the_roughness_of_a_ramp) {
    const Setting setting;
    ForceQuality quality = setting.quality();
    quality.begin_run();
    for (int tick = 0; tick <= 100; ++tick) quality.add(with_force(0.01 * tick), Vector3d::Zero());
    EXPECT_NEAR(quality.figures().rendered.roughness(), 10, rounding * 1e3);
    EXPECT_EQ(quality.figures().rendered.jumps, 0);
    quality.add(with_force(1.5), Vector3d::Zero());
    EXPECT_EQ(quality.figures().rendered.jumps, 0);
    quality.add(with_force(0.9), Vector3d::Zero());
    EXPECT_EQ(quality.figures().rendered.jumps, 1);
    EXPECT_NEAR(quality.figures().rendered.largest, 0.6, rounding);
    quality.begin_run();  // what follows has no tick before it
    quality.add(with_force(-3), Vector3d::Zero());
    EXPECT_EQ(quality.figures().rendered.jumps, 1);
}

// A wall at x = 0 that is felt where the reading, to a grain, is below it.
ForceFigures pushed_at_random(const Setting& setting, double grain, double gain) {
    std::mt19937_64 random(3);
    std::normal_distribution<double> step(0, 0.03);
    ForceQuality quality = setting.quality(grain);
    quality.begin_run();
    double x = 0;
    for (int tick = 0; tick < 20000; ++tick) {
        const double read = grain > 0 ? std::floor(x / grain) * grain : x;
        quality.add(with_force(read < 0 ? -gain * stiffness * read : 0), {x, 0, 0});
        x = std::clamp(x + step(random), -1.0, 1.0);
    }
    return quality.figures();
}

TEST(ForceQuality, a_sampled_spring_gives_no_more_than_its_bound) {
    const Setting setting;
    for (const double grain : {0.0, 0.01, 0.05}) {
        const ForceFigures figures = pushed_at_random(setting, grain, 1);
        EXPECT_GT(figures.episodes, 20);
        EXPECT_EQ(figures.over_bound, 0) << grain;
        EXPECT_GT(figures.most_given, 0);
    }
}

TEST(ForceQuality, a_force_that_adds_energy_exceeds_the_bound) {
    const Setting setting;
    EXPECT_GT(pushed_at_random(setting, 0, 3).over_bound, 0);  // three times as stiff as is said
}

TEST(ForceQuality, a_closed_excursion_gives_half_k_dx_squared_a_tick) {
    const Setting setting;
    ForceQuality quality = setting.quality();
    quality.begin_run();
    double sum = 0, last = 0;
    for (int tick = 0; tick <= 50; ++tick) {
        const double x = tick == 50 ? 0 : -std::sin(std::numbers::pi * tick / 50);
        quality.add(with_force(-stiffness * x), {x, 0, 0});
        sum += stiffness * (x - last) * (x - last) / 2;
        last = x;
    }
    EXPECT_NEAR(quality.figures().given, sum, rounding);
    EXPECT_NEAR(quality.figures().bound, sum, rounding);
    EXPECT_EQ(quality.figures().episodes, 1);
}

}  // namespace
}  // namespace palpate::experiments
