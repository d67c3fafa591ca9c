// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>
#include <numeric>
#include <random>

#include "formats/model/errors.hpp"
#include "tests/tools/real_data.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/obb/build_obb_tree.hpp"

namespace palpate {
namespace {

using namespace obb;

// A torus far from the origin, where float32 is coarse: 40 by 20 quads, halved.
TriangleMesh torus() {
    constexpr int around = 40, across = 20;
    TriangleMesh surface;
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            const double a = 2 * std::numbers::pi * i / around, b = 2 * std::numbers::pi * j / across;
            const double r = 30 + 8 * std::cos(b);
            surface.vertices.emplace_back(-412.3 + r * std::cos(a), 733.1 + r * std::sin(a),
                                          -1201.7 + 8 * std::sin(b));
        }
    const auto at = [](int i, int j) { return i % around * across + j % across; };
    for (int i = 0; i < around; ++i)
        for (int j = 0; j < across; ++j) {
            surface.triangles.push_back({at(i, j), at(i + 1, j), at(i + 1, j + 1)});
            surface.triangles.push_back({at(i, j), at(i + 1, j + 1), at(i, j + 1)});
        }
    return surface;
}

TriangleMesh random_triangles(std::size_t count) {
    std::mt19937 random(7);
    std::uniform_real_distribution<double> place(-100, 100), size(-5, 5);
    TriangleMesh surface;
    for (std::size_t t = 0; t < count; ++t) {
        const Eigen::Vector3d p(place(random), place(random), place(random));
        for (int c = 0; c < 3; ++c)
            surface.vertices.push_back(p + Eigen::Vector3d(size(random), size(random), size(random)));
        const auto first = static_cast<std::int32_t>(3 * t);
        surface.triangles.push_back({first, first + 1, first + 2});
    }
    return surface;
}

// The test that the tick makes, in float32 throughout.
bool inside_in_float(const ObbNode& box, const Eigen::Vector3d& p) {
    const Eigen::Vector3f local = box.axes * (p.cast<float>() - box.center);
    return (local.array().abs() <= box.half_extents.array()).all();
}

// The triangles below a node, gathered by walking; also checks that children come after their parent.
std::vector<std::int32_t> triangles_below(const ObbTree& tree, std::size_t node) {
    const ObbNode& box = tree.nodes[node];
    if (box.count > 0)
        return {tree.triangle_order.begin() + box.first, tree.triangle_order.begin() + box.first + box.count};
    const auto left = static_cast<std::size_t>(box.first);
    EXPECT_GT(left, node);
    EXPECT_LT(left + 1, tree.nodes.size());
    std::vector<std::int32_t> all = triangles_below(tree, left);
    std::ranges::copy(triangles_below(tree, left + 1), std::back_inserter(all));
    return all;
}

void expect_sound(const ObbTree& tree, const TriangleMesh& surface, std::int32_t max_leaf) {
    for (std::size_t n = 0; n < tree.nodes.size(); ++n) {
        const ObbNode& box = tree.nodes[n];
        EXPECT_LE(box.count, max_leaf);
        EXPECT_TRUE(box.axes.allFinite() && box.center.allFinite() && box.half_extents.allFinite());
        // Rows are unit vectors at right angles to float32 accuracy.
        EXPECT_LT((box.axes * box.axes.transpose() - Eigen::Matrix3f::Identity()).norm(), 1e-6F);
        EXPECT_GT(box.axes.determinant(), 0);
        for (const std::int32_t t : triangles_below(tree, n))
            for (const std::int32_t v : surface.triangles[static_cast<std::size_t>(t)])
                ASSERT_TRUE(inside_in_float(box, surface.vertices[static_cast<std::size_t>(v)]))
                    << "node " << n << ", triangle " << t;
    }
    std::vector<std::int32_t> order = tree.triangle_order, below = triangles_below(tree, 0);
    std::ranges::sort(order);
    std::ranges::sort(below);
    std::vector<std::int32_t> all(surface.triangles.size());
    std::iota(all.begin(), all.end(), 0);
    EXPECT_EQ(order, all);
    EXPECT_EQ(below, all);
}

std::size_t depth(const ObbTree& tree, std::size_t node = 0) {
    if (tree.nodes[node].count > 0) return 1;
    const auto left = static_cast<std::size_t>(tree.nodes[node].first);
    return 1 + std::max(depth(tree, left), depth(tree, left + 1));
}

bool same_bytes(const ObbTree& a, const ObbTree& b) {
    return a.triangle_order == b.triangle_order && a.nodes.size() == b.nodes.size() &&
           std::memcmp(a.nodes.data(), b.nodes.data(), a.nodes.size() * sizeof(ObbNode)) == 0;
}

TEST(ObbTree, every_box_encloses_all_triangles_below_it_in_float32) {
    expect_sound(build_obb_tree(torus()), torus(), 4);
    const TriangleMesh soup = random_triangles(500);
    expect_sound(build_obb_tree(soup), soup, 4);
    expect_sound(build_obb_tree(soup, {.max_leaf_triangles = 1}), soup, 1);
}

TEST(ObbTree, box_of_a_turned_plate_is_flat_and_tight) {
    // A 40 x 10 rectangle, turned about an oblique axis: its box must be 20, 5 and 0 in half extent.
    const Eigen::AngleAxisd turn(0.7, Eigen::Vector3d(1, 2, 3).normalized());
    TriangleMesh plate;
    for (const auto& [x, y] : {std::pair(-20, -5), std::pair(20, -5), std::pair(20, 5), std::pair(-20, 5)})
        plate.vertices.push_back(turn * Eigen::Vector3d(x, y, 0) + Eigen::Vector3d(10, 20, 30));
    plate.triangles = {{0, 1, 2}, {0, 2, 3}};
    Eigen::Vector3f extents = build_obb_tree(plate).nodes[0].half_extents;
    std::ranges::sort(extents);
    EXPECT_NEAR(extents[0], 0, 1e-3);
    EXPECT_NEAR(extents[1], 5, 1e-3);
    EXPECT_NEAR(extents[2], 20, 1e-3);
}

TEST(ObbTree, equal_surfaces_give_equal_trees) {
    EXPECT_TRUE(same_bytes(build_obb_tree(random_triangles(500)), build_obb_tree(random_triangles(500))));
}

TEST(ObbTree, one_triangle_is_one_leaf) {
    TriangleMesh surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 2}}};
    const ObbTree tree = build_obb_tree(surface);
    ASSERT_EQ(tree.nodes.size(), 1U);
    EXPECT_EQ(tree.nodes[0].count, 1);
    expect_sound(tree, surface, 4);
}

TEST(ObbTree, triangles_without_area_are_enclosed_too) {
    TriangleMesh points{{{5, 6, 7}}, std::vector<Triangle>(37, Triangle{0, 0, 0})};
    expect_sound(build_obb_tree(points), points, 4);
    TriangleMesh needles;
    for (int i = 0; i < 50; ++i) needles.vertices.emplace_back(i, 2 * i, -i);
    for (int i = 0; i + 2 < 50; ++i) needles.triangles.push_back({i, i + 1, i + 2});
    expect_sound(build_obb_tree(needles), needles, 4);
}

TEST(ObbTree, triangles_on_one_another_are_parted) {
    TriangleMesh stack{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, std::vector<Triangle>(1000, Triangle{0, 1, 2})};
    const ObbTree tree = build_obb_tree(stack);
    expect_sound(tree, stack, 4);
    EXPECT_LE(depth(tree), 9U);  // halved each time: 1000 -> 4 in 8 steps
}

TEST(ObbTree, depth_stays_logarithmic_when_sizes_differ_by_powers) {
    // Each triangle twice as far and as large as the one before: the mean always splits off the last few.
    TriangleMesh surface;
    for (int i = 0; i < 60; ++i) {
        const double x = std::exp2(i);
        for (const Eigen::Vector3d& p :
             {Eigen::Vector3d(x, 0, 0), Eigen::Vector3d(1.5 * x, 0, 0), Eigen::Vector3d(x, 0.1 * x, 0)})
            surface.vertices.push_back(p);
        surface.triangles.push_back({3 * i, 3 * i + 1, 3 * i + 2});
    }
    // Without the median the tree would be a chain of 60.
    EXPECT_LE(static_cast<double>(depth(build_obb_tree(surface, {.max_leaf_triangles = 1}))),
              1 + std::ceil(std::log(60.0) / std::log(10.0 / 9)));
}

TEST(ObbTree, empty_surface_is_refused) {
    EXPECT_THROW(build_obb_tree({}), InvalidInput);
}

TEST(ObbTree, invalid_vertices_and_options_are_refused) {
    TriangleMesh surface{{{0, 0, 0}, {1, 0, 0}, {0, 1, 0}}, {{0, 1, 3}}};
    EXPECT_THROW(build_obb_tree(surface), InvalidInput);
    surface.triangles[0][2] = -1;
    EXPECT_THROW(build_obb_tree(surface), InvalidInput);
    surface.triangles[0][2] = 2;
    EXPECT_THROW(build_obb_tree(surface, {.max_leaf_triangles = 0}), InvalidInput);
    surface.vertices[1].x() = std::numeric_limits<double>::infinity();
    EXPECT_THROW(build_obb_tree(surface), InvalidInput);
}

TEST(ObbTree, skull_of_a_real_head_is_enclosed) {
    REQUIRE_REAL_DATA(path, "bench_skull/skull.vtp");
    const TriangleMesh skull = meshing::read_surface(path);
    const ObbTree tree = build_obb_tree(skull);
    EXPECT_LE(depth(tree), 40U);
    // Walking from every node is quadratic on a large tree; boxes hold what their children hold, so it is
    // enough to follow each triangle's path down.
    std::vector<std::int32_t> parent(tree.nodes.size(), -1);
    for (std::size_t n = 0; n < tree.nodes.size(); ++n)
        if (tree.nodes[n].count == 0)
            for (const std::int32_t child : {tree.nodes[n].first, tree.nodes[n].first + 1})
                parent[static_cast<std::size_t>(child)] = static_cast<std::int32_t>(n);
    std::size_t outside = 0, seen = 0;
    for (std::size_t n = 0; n < tree.nodes.size(); ++n)
        for (std::int32_t i = 0; i < tree.nodes[n].count; ++i, ++seen) {
            const auto t = static_cast<std::size_t>(
                tree.triangle_order[static_cast<std::size_t>(tree.nodes[n].first + i)]);
            for (auto at = static_cast<std::int32_t>(n); at >= 0; at = parent[static_cast<std::size_t>(at)])
                for (const std::int32_t v : skull.triangles[t])
                    outside += !inside_in_float(tree.nodes[static_cast<std::size_t>(at)],
                                                skull.vertices[static_cast<std::size_t>(v)]);
        }
    EXPECT_EQ(seen, skull.triangles.size());
    EXPECT_EQ(outside, 0U);
}

}  // namespace
}  // namespace palpate
