// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <bit>
#include <cmath>
#include <functional>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <random>

#include "formats/model/closure.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/tet_mesh.hpp"
#include "runtime/collision/field/distance_field.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/collision/collision_scene.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;
using Eigen::Vector3i;

constexpr double voxel = sanitized ? 1.4 : 0.7, band = 2.5;  // mm
constexpr int points = samples_of(10000);

// mm: positions on the grid are rounded in double, at coordinates up to 100 mm, and so are distances.
constexpr double rounding = 1e-10;

TriangleMesh torus(double radius, double tube) {
    constexpr std::int32_t around = 36, across = 14;
    TriangleMesh mesh;
    for (std::int32_t i = 0; i < around; ++i)
        for (std::int32_t j = 0; j < across; ++j) {
            const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
            const double r = radius + tube * std::cos(b);
            mesh.vertices.emplace_back(r * std::cos(a), r * std::sin(a), tube * std::sin(b));
            const auto at = [&](std::int32_t k, std::int32_t l) {
                return across * ((i + k) % around) + (j + l) % across;
            };
            mesh.triangles.push_back({at(0, 0), at(1, 0), at(1, 1)});
            mesh.triangles.push_back({at(0, 0), at(1, 1), at(0, 1)});
        }
    return mesh;
}

// A ball with a cavity.
TriangleMesh hollow_sphere(double outer, double inner) {
    TriangleMesh mesh = sample::sphere_surface(Vector3d::Zero(), outer, 3);
    const TriangleMesh cavity = sample::sphere_surface(Vector3d::Zero(), inner, 2);
    const auto first = static_cast<std::int32_t>(mesh.vertices.size());
    mesh.vertices.insert(mesh.vertices.end(), cavity.vertices.begin(), cavity.vertices.end());
    for (const Triangle& t : cavity.triangles)
        mesh.triangles.push_back({first + t[0], first + t[2], first + t[1]});
    return mesh;
}

struct NamedSolid {
    const char* name;
    std::function<TriangleMesh()> make;
};

const NamedSolid solids[]{{"sphere",
                           [] {
                               return sample::sphere_surface({120, -80, 40}, 12, 3);
                           }},
                          {"box", [] { return boundary_surface(sample::cube_mesh(2, 20)).surface; }},
                          {"torus", [] { return torus(12, 5); }},
                          {"hollow_sphere", [] { return hollow_sphere(20, 9); }},
                          {"spiky_ball", [] { return spiky_ball(5); }}};

class FieldOf : public testing::TestWithParam<NamedSolid> {
  protected:
    TriangleMesh mesh_ = GetParam().make();
    CollisionSurface surface_{mesh_, sample::median_tree(mesh_, 4), "solid"};
    DistanceField field_{surface_, voxel, band, 2};
    std::mt19937 generator_{17};

    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(generator_);
    }
    int below(int count) { return std::uniform_int_distribution<int>(0, count - 1)(generator_); }

    // In turn: anywhere in the grid and a little beyond, and within two bands of the surface.
    Vector3d query(int i) {
        if (i % 2 == 0) {
            const Eigen::Array3d end = voxel * field_.cells().cast<double>().array() + band;
            return field_.origin() +
                   Vector3d(uniform(-band, end[0]), uniform(-band, end[1]), uniform(-band, end[2]));
        }
        return surface_.corners(below(surface_.triangle_count()))[0] + in_cube(2 * band, generator_);
    }
    bool in_grid(const Vector3d& p) {
        const Eigen::Array3d cells = (p - field_.origin()).array() / voxel;
        return cells.minCoeff() >= 0 && (cells < field_.cells().cast<double>().array()).all();
    }
    Vector3d sample(const Vector3i& index) { return field_.origin() + voxel * index.cast<double>(); }
    Vector3i any_sample() {
        const Vector3i cells = field_.cells();
        return {below(cells[0]), below(cells[1]), below(cells[2])};
    }

    // By all triangles, with the sign of the winding number, which asks for no nearest point.
    double signed_distance(const Vector3d& p) {
        double squared = std::numeric_limits<double>::infinity();
        for (std::int32_t slot = 0; slot < surface_.triangle_count(); ++slot)
            squared =
                std::min(squared, closest_point_on_triangle(p, surface_.corners(slot)).squared_distance);
        return winding_number(mesh_, p) > 0.5 ? -std::sqrt(squared) : std::sqrt(squared);
    }
    double clamped(double distance) { return std::clamp(distance, -field_.band(), field_.band()); }
};

TEST_P(FieldOf, a_solid_is_within_its_error_of_the_distance_to_all_triangles) {
    for (int i = 0; i < points; ++i) {
        const Vector3d p = query(i);
        ASSERT_NEAR(field_.at(p).distance, clamped(signed_distance(p)), field_.error() + rounding)
            << p.transpose();
    }
}

TEST_P(FieldOf, a_solid_has_its_side_where_the_surface_is_farther_than_the_error) {
    for (int i = 0; i < points; ++i) {
        const Vector3d p = query(i);
        const double distance = signed_distance(p);
        if (std::abs(distance) <= field_.error()) continue;
        ASSERT_EQ(field_.at(p).distance > 0, distance > 0) << p.transpose();
    }
}

TEST_P(FieldOf, a_solid_is_its_distance_at_samples) {
    const double float_rounding = 0x1p-24 * field_.band();
    for (int i = 0; i < points; ++i) {
        const Vector3d p = sample(any_sample());
        ASSERT_NEAR(field_.at(p).distance, clamped(signed_distance(p)), float_rounding + rounding)
            << p.transpose();
    }
}

TEST_P(FieldOf, a_solid_has_the_gradient_of_its_interpolant) {
    // Along an axis it is linear within a cell, so that a difference is off by rounding alone.
    constexpr double step = 0.1 * voxel, tolerance = 1e-9;
    for (int i = 0; i < points; ++i) {
        const Vector3d part(uniform(0.2, 0.8), uniform(0.2, 0.8), uniform(0.2, 0.8));
        const Vector3d p = sample(any_sample()) + voxel * part;
        const Vector3d gradient = field_.at(p).gradient;
        for (int axis = 0; axis < 3; ++axis) {
            const Vector3d along = step * Vector3d::Unit(axis);
            const double difference = field_.at(p + along).distance - field_.at(p - along).distance;
            ASSERT_NEAR(gradient[axis], difference / (2 * step), tolerance) << p.transpose();
        }
    }
}

TEST_P(FieldOf, a_solid_is_continuous_across_bricks_and_at_the_grids_end) {
    // Neighbouring samples differ by at most a voxel, so that no slope along an axis is above 1.
    constexpr double step = 1e-7, brick = 8;
    for (int i = 0; i < points; ++i) {
        const int axis = i % 3;
        Vector3d p = query(i);
        const double bricks = std::round((p - field_.origin())[axis] / (brick * voxel));
        p[axis] = field_.origin()[axis] + bricks * brick * voxel;
        const Vector3d along = step * Vector3d::Unit(axis);
        const double low = field_.at(p - along).distance, high = field_.at(p + along).distance;
        ASSERT_LE(std::abs(high - low), 2 * step + rounding) << p.transpose();
    }
}

TEST_P(FieldOf, a_solid_is_as_clear_as_it_says_and_not_far_less) {
    const double across_a_brick = 8 * std::numbers::sqrt3 * voxel;
    for (int i = 0; i < points; ++i) {
        const Vector3d p = query(i);
        const double distance = std::abs(signed_distance(p)), clearance = field_.clearance(p);
        ASSERT_LE(clearance, distance + rounding) << p.transpose();
        if (!in_grid(p)) continue;
        ASSERT_GE(clearance, std::min(distance, field_.band()) - 2 * field_.error() - rounding);
        ASSERT_GE(clearance, distance - field_.band() - across_a_brick) << p.transpose();
    }
}

INSTANTIATE_TEST_SUITE_P(All, FieldOf, testing::ValuesIn(solids),
                         [](const auto& info) { return std::string(info.param.name); });

DistanceField field_of(const TriangleMesh& mesh, double voxel_mm, double band_mm, std::size_t threads = 1) {
    const CollisionSurface surface(mesh, sample::median_tree(mesh, 4), "solid");
    return DistanceField(surface, voxel_mm, band_mm, threads);
}

void expect_constant(const FieldSample& found, double distance) {
    EXPECT_EQ(found.distance, distance);
    EXPECT_TRUE(found.gradient.isZero(0));
}

TEST(DistanceField, far_from_the_surface_is_the_band_of_its_side) {
    const DistanceField field = field_of(hollow_sphere(40, 15), 1, 2);
    EXPECT_EQ(field.band(), 2);
    for (const Vector3d& way : {Vector3d(1, 0, 0), Vector3d(0, -1, 0), Vector3d(0.6, 0, 0.8)}) {
        expect_constant(field.at(0 * way), 2);  // in the cavity
        expect_constant(field.at(9 * way), 2);
        expect_constant(field.at(27 * way), -2);  // in the shell
        expect_constant(field.at(45 * way), 2);   // outside
        expect_constant(field.at(1e6 * way), 2);
        EXPECT_GT(field.clearance(27 * way), 3);
        EXPECT_NEAR(field.clearance(1e6 * way), 1e6, 60);
    }
    expect_constant(field.at(Vector3d::Constant(std::numeric_limits<double>::infinity())), 2);
    expect_constant(field.at(Vector3d::Constant(std::numeric_limits<double>::quiet_NaN())), 2);
}

TEST(DistanceField, stores_little_more_than_the_band) {
    constexpr double radius = 40, fine = 1, near = 2;
    const DistanceField field = field_of(sample::sphere_surface({0, 0, 0}, radius, 3), fine, near);
    // Every brick with a sample in the band lies within the band and a brick's diagonal.
    const double thickness = 2 * (near + 8 * std::numbers::sqrt3 * fine);
    const double bricks = 4 * std::numbers::pi * radius * radius * thickness * 1.1 / std::pow(8 * fine, 3);
    const double grid = field.cells().cast<double>().prod() / std::pow(8, 3);
    EXPECT_LE(static_cast<double>(field.bytes()), bricks * 729 * 4 + grid * 8);
}

TEST(DistanceField, is_the_same_to_the_bit_on_any_number_of_threads) {
    const TriangleMesh mesh = torus(12, 5);
    const DistanceField one = field_of(mesh, voxel, band, 1);
    for (const std::size_t threads : {2, 5}) {
        const DistanceField other = field_of(mesh, voxel, band, threads);
        ASSERT_EQ(one.bytes(), other.bytes());
        ASSERT_EQ(one.cells(), other.cells());
        for (int z = 0; z < one.cells()[2]; ++z)
            for (int y = 0; y < one.cells()[1]; ++y)
                for (int x = 0; x < one.cells()[0]; ++x) {
                    const Vector3d p = one.origin() + voxel * Vector3d(x, y, z);
                    const auto bits = [&](double value) { return std::bit_cast<std::uint64_t>(value); };
                    ASSERT_EQ(bits(one.at(p).distance), bits(other.at(p).distance)) << p.transpose();
                    ASSERT_EQ(one.at(p).gradient, other.at(p).gradient) << p.transpose();
                    ASSERT_EQ(bits(one.clearance(p)), bits(other.clearance(p))) << p.transpose();
                }
    }
}

TEST(DistanceField, refuses_lengths_that_make_no_field) {
    const TriangleMesh mesh = sample::sphere_surface({0, 0, 0}, 12, 0);
    constexpr double infinity = std::numeric_limits<double>::infinity();
    for (const double wrong : {0.0, -1.0, infinity, std::numeric_limits<double>::quiet_NaN()}) {
        EXPECT_THROW(field_of(mesh, wrong, 3), InvalidInput) << wrong;
        EXPECT_THROW(field_of(mesh, 1, wrong), InvalidInput) << wrong;
    }
    EXPECT_THROW(field_of(mesh, 1, 1.73), InvalidInput);
    EXPECT_NO_THROW(field_of(mesh, 1, 1.74));
}

TEST(DistanceField, refuses_what_would_take_too_much_and_names_a_voxel_that_fits) {
    const TriangleMesh mesh = sample::sphere_surface({0, 0, 0}, 12, 0);
    const auto advice = [&](double voxel_mm, double band_mm) -> std::string {
        try {
            field_of(mesh, voxel_mm, band_mm);
        } catch (const InvalidInput& error) {
            return error.detail().next_step;
        }
        return "none";
    };
    EXPECT_EQ(advice(1, 1.5), "a voxel of 0.857365 mm fits");  // by the band
    EXPECT_NO_THROW(field_of(mesh, 0.857365, 1.5));
    EXPECT_EQ(advice(0.01, 1), "a voxel of 0.014514 mm fits");   // by the grid
    EXPECT_EQ(advice(1e-30, 1).substr(0, 11), "a voxel of ");    // the same, beyond counting
    EXPECT_EQ(advice(0.11, 30).substr(0, 13), "a voxel of 0.");  // by its bytes
}

}  // namespace
}  // namespace palpate
