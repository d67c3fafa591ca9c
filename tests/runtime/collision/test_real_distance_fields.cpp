// SPDX-License-Identifier: GPL-3.0-or-later
// Distance fields of surfaces of real anatomy, against nearest points and winding numbers.
#include <algorithm>
#include <chrono>
#include <cmath>
#include <gtest/gtest.h>
#include <iostream>
#include <random>

#include "formats/model/closure.hpp"
#include "runtime/collision/field/distance_field.hpp"
#include "tests/runtime/collision/collision_scene.hpp"
#include "tests/tools/real_data.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/obb/build_obb_tree.hpp"

namespace palpate {
namespace {

using namespace collision;
using Eigen::Vector3d;

// mm: of positions on the grid and of distances in double, at coordinates up to 1000 mm.
constexpr double rounding = 1e-9;

class RealField : public testing::Test {
  protected:
    DistanceField build(double voxel, double band) {
        surface_.emplace(mesh_, obb::build_obb_tree(mesh_), "surface");
        const auto start = std::chrono::steady_clock::now();
        DistanceField field(*surface_, voxel, band, 1);
        const std::chrono::duration<double> took = std::chrono::steady_clock::now() - start;
        std::cout << mesh_.triangles.size() << " triangles, voxel " << voxel << " mm, band " << band
                  << " mm: " << took.count() << " s, " << static_cast<double>(field.bytes()) / 1e6 << " MB\n";
        return field;
    }
    Vector3d near_the_surface(double reach) {
        std::uniform_int_distribution<std::int32_t> slots(0, surface_->triangle_count() - 1);
        return surface_->corners(slots(generator_))[0] + in_cube(reach, generator_);
    }
    double unsigned_distance(const Vector3d& p) { return surface_->closest_point(p, 1e6)->distance; }

    TriangleMesh mesh_;
    std::optional<CollisionSurface> surface_;
    std::mt19937 generator_{23};
};

// The bench's skull has holes, about which a side has no meaning; the distance has.
TEST_F(RealField, of_a_skull_has_its_distance_at_every_sample_and_is_clear_everywhere) {
    REQUIRE_REAL_DATA(path, "bench_skull/skull.vtp");
    mesh_ = meshing::read_surface(path);
    const DistanceField field = build(1, 3);
    for (int i = 0; i < 200000; ++i) {
        const Vector3d p = near_the_surface(5);
        ASSERT_LE(field.clearance(p), unsigned_distance(p) + rounding) << p.transpose();
        const Vector3d index = ((p - field.origin()) / field.voxel()).array().round();
        const Vector3d sample = field.origin() + field.voxel() * index;
        const double expected = std::min(unsigned_distance(sample), field.band());
        ASSERT_NEAR(std::abs(field.at(sample).distance), expected, 0x1p-24 * field.band() + rounding)
            << sample.transpose();
    }
}

TEST_F(RealField, of_a_liver_is_within_its_error_and_has_its_side) {
    REQUIRE_REAL_DATA(path, "mesh_sofa/liver.obj");
    mesh_ = meshing::read_imported_surface(path, {}, {});
    const DistanceField field = build(0.05, 0.3);  // the file's unit is a centimetre or so
    for (int i = 0; i < 10000; ++i) {
        const Vector3d p = near_the_surface(0.5);
        const double side = winding_number(mesh_, p) > 0.5 ? -1 : 1, distance = side * unsigned_distance(p);
        ASSERT_NEAR(field.at(p).distance, std::clamp(distance, -field.band(), field.band()),
                    field.error() + rounding)
            << p.transpose();
    }
}

}  // namespace
}  // namespace palpate
