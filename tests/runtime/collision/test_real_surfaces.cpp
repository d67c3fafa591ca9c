// SPDX-License-Identifier: GPL-3.0-or-later
// Collision queries against CGAL's AABB tree (Alliez, Tayeb, Wormser 2009) on surfaces of real anatomy.
#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <filesystem>
#include <gtest/gtest.h>
#include <iterator>
#include <random>
#include <vector>

#include "runtime/collision/collision_surface.hpp"
#include "tests/tools/real_data.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"
#include "tools/obb/build_obb_tree.hpp"

namespace palpate {
namespace {

using namespace collision;
using namespace meshing;
using Eigen::Vector3d;
using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::iterator>;
using AabbTree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

constexpr int query_count = 1'000'000;

// mm. Both compute in double on the same float32 vertices, at coordinates up to 1000 mm, where a distance has
// lost 1e-10 mm; where a segment grazes a triangle, the place along it has lost more. Measured: distances
// differ by up to 2e-11 mm, places by up to 4e-9 mm.
constexpr double tolerance = 1e-8;

// Of the way. A point that passes through an edge meets a cylinder of radius 0; its double root has half the
// digits of a double, 1.5e-8.
constexpr double edge_tolerance = 1e-7;

Kernel::Point_3 cgal(const Vector3d& p) {
    return {p[0], p[1], p[2]};
}

struct NamedSurface {
    const char* name;
    const char* file;
    TriangleMesh (*read)(const std::filesystem::path& path);
};

TriangleMesh read_labels(const std::filesystem::path& path) {
    const LabelMap map = imaging::read_label_map(path);
    std::vector<std::int32_t> values;
    for (const Label& label : map.names) values.push_back(label.value);
    return label_surface(map, values);
}

TriangleMesh read_obj(const std::filesystem::path& path) {
    return read_imported_surface(path, {}, {});
}

const NamedSurface surfaces[]{
    {"skull", "bench_skull/skull.vtp", read_surface},
    {"smooth_liver", "mesh_sofa/liver-smooth.obj", read_obj},
    {"coarse_liver", "mesh_sofa/liver.obj", read_obj},
    {"abdomen", "abdomen_ct_totalseg3mm/seg_totalseg.nii.gz", read_labels},
    {"bones_of_a_head", "head_ct_cranium/head_ct_cranium_mask_bone.nrrd", read_labels}};

// Both trees over one surface, and queries that hit it everywhere.
class RealSurface : public testing::TestWithParam<NamedSurface> {
  protected:
    void SetUp() override {
        REQUIRE_REAL_DATA(path, GetParam().file);
        const TriangleMesh mesh = GetParam().read(path);
        surface_.emplace(mesh, obb::build_obb_tree(mesh), GetParam().name);
        for (std::int32_t slot = 0; slot < surface_->triangle_count(); ++slot) {
            const TriangleCorners t = surface_->corners(slot);
            triangles_.emplace_back(cgal(t[0]), cgal(t[1]), cgal(t[2]));
            for (const Vector3d& corner : t) box_.extend(corner);
        }
        tree_.rebuild(triangles_.begin(), triangles_.end());
        tree_.accelerate_distance_queries();
    }

    double uniform(double low, double high) {
        return std::uniform_real_distribution<double>(low, high)(generator_);
    }
    Vector3d direction() {
        std::normal_distribution<double> axis;
        const double x = axis(generator_), y = axis(generator_), z = axis(generator_);
        return Vector3d(x, y, z).normalized();
    }
    // A corner, a point on an edge or on a face.
    Vector3d on_surface(int kind) {
        const TriangleCorners t = surface_->corners(
            std::uniform_int_distribution<std::int32_t>(0, surface_->triangle_count() - 1)(generator_));
        if (kind == 0) return t[0];
        const double s = uniform(0, 1), r = kind == 1 ? 0 : uniform(0, 1 - s);
        return t[0] + s * (t[1] - t[0]) + r * (t[2] - t[0]);
    }
    Vector3d in_the_box() {
        const Vector3d grown = 1.2 * box_.sizes();
        return box_.center() +
               Vector3d(uniform(-0.5, 0.5), uniform(-0.5, 0.5), uniform(-0.5, 0.5)).cwiseProduct(grown);
    }
    // Anywhere, on corners, edges and faces, and from 1e-6 to 10 mm off them.
    Vector3d query(int i) {
        switch (i % 8) {
            case 0:
            case 1:
                return in_the_box();
            case 2:
                return on_surface(0);
            case 3:
                return on_surface(1);
            case 4:
                return on_surface(2);
            default:
                return on_surface(i % 3) + std::pow(10, uniform(-6, 1)) * direction();
        }
    }

    std::optional<CollisionSurface> surface_;
    Triangles triangles_;
    AabbTree tree_;
    Eigen::AlignedBox3d box_;
    std::mt19937_64 generator_{7};
};

TEST_P(RealSurface, closest_point_is_as_near_as_cgals) {
    double worst = 0;
    std::int32_t hint = -1;
    for (int i = 0; i < query_count; ++i) {
        const Vector3d p = query(i);
        const auto found = surface_->closest_point(p, 1e6, hint);
        ASSERT_TRUE(found) << p.transpose();
        const double difference = std::abs(found->distance - std::sqrt(tree_.squared_distance(cgal(p))));
        ASSERT_LE(difference, tolerance) << "query " << i << " at " << p.transpose();
        ASSERT_NEAR((p - found->point).norm(), found->distance, tolerance);
        worst = std::max(worst, difference);
        hint = found->slot;
    }
    std::cout << triangles_.size() << " triangles, " << query_count << " queries, distances differ by up to "
              << worst << " mm\n";
}

// Fraction of the segment at which CGAL first meets the surface; 2 if it does not.
double first_fraction(const AabbTree& tree, const Vector3d& from, const Vector3d& way) {
    using Intersection = AabbTree::Intersection_and_primitive_id<Kernel::Segment_3>::Type;
    static std::vector<Intersection> all;
    all.clear();
    tree.all_intersections(Kernel::Segment_3(cgal(from), cgal(Vector3d(from + way))),
                           std::back_inserter(all));
    double first = 2;
    const auto consider = [&](const Kernel::Point_3& p) {
        first = std::min(first, way.dot(Vector3d(p.x(), p.y(), p.z()) - from) / way.squaredNorm());
    };
    for (const Intersection& one : all) {
        if (const auto* point = boost::get<Kernel::Point_3>(&one.first)) consider(*point);
        if (const auto* part = boost::get<Kernel::Segment_3>(&one.first)) {
            consider(part->source());
            consider(part->target());
        }
    }
    return first;
}

TEST_P(RealSurface, sweep_of_a_point_stops_where_cgals_segment_first_meets_the_surface) {
    double worst = 0, worst_at_edge = 0;
    int hits = 0, at_edges = 0;
    for (int i = 0; i < query_count; ++i) {
        // Through anything, and through corners, edges and faces.
        const Vector3d from = in_the_box();
        const Vector3d to =
            i % 4 == 3 ? in_the_box() : Vector3d(from + uniform(1, 2) * (on_surface(i % 4) - from));
        const Vector3d way = to - from;
        const double expected = first_fraction(tree_, from, way);
        const auto found = surface_->sweep_sphere(from, to, 0);
        const double fraction = found ? found->fraction : 2;
        hits += expected <= 1;
        const double difference = std::abs(fraction - expected) * way.norm();
        if (difference <= tolerance) {
            worst = std::max(worst, difference);
            continue;
        }
        // Only earlier than CGAL, and only at an edge, which CGAL meets a little later or just misses.
        ASSERT_TRUE(found && fraction < expected)
            << "query " << i << ": " << fraction << ", CGAL " << expected;
        const Vector3d at = from + fraction * way;
        const double off = std::sqrt(tree_.squared_distance(cgal(at))) / way.norm();
        ASSERT_LE(off, edge_tolerance) << "query " << i << ": " << fraction << ", CGAL " << expected;
        worst_at_edge = std::max(worst_at_edge, off);
        ++at_edges;
    }
    std::cout << triangles_.size() << " triangles, " << query_count << " segments, " << hits
              << " meet the surface; places differ by up to " << worst << " mm, but for " << at_edges
              << " at edges, off the surface by up to " << worst_at_edge << " of the way\n";
}

INSTANTIATE_TEST_SUITE_P(All, RealSurface, testing::ValuesIn(surfaces),
                         [](const auto& info) { return std::string(info.param.name); });

}  // namespace
}  // namespace palpate
