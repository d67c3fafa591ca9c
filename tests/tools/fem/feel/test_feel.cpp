// SPDX-License-Identifier: GPL-3.0-or-later
// What can be felt: against Hertz, against bodies condensed anew, and by what must hold of any region.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/feel/feel.hpp"
#include "tools/fem/feel/pressing.hpp"

namespace palpate {
namespace {

using namespace fem;
using Eigen::Vector3d;

constexpr Material felt_tissue{.youngs_modulus = 6.3e-3, .poissons_ratio = 0.45};
// Stored compliances are float32, and so are stiffnesses: 1e-7 relative each, a few dozen of them summed.
constexpr double felt_rounding = 1e-5;
constexpr std::int32_t lump = 2;
constexpr double top = 24;  // mm

// A block of 40 x 40 x 24 mm held below; region 2 are the tetrahedra with centroids between two heights
// within 8 mm of the middle axis, of a material that is `factor` times as stiff.
DeformableBody block_with_lump(double low, double high, double factor) {
    DeformableBody body = test::held_block({10, 10, 6}, {40, 40, top}, felt_tissue);
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
        Vector3d centroid = Vector3d::Zero();
        for (const std::int32_t node : body.mesh.tetrahedra[t])
            centroid += body.mesh.rest_positions[static_cast<std::size_t>(node)] / 4;
        if (centroid.z() > low && centroid.z() < high && std::hypot(centroid.x() - 20, centroid.y() - 20) < 8)
            body.mesh.regions[t] = lump;
    }
    body.mesh.region_names = {{1, "tissue", {0.5F, 0.5F, 0.5F}}, {lump, "lump", {0.9F, 0.5F, 0.5F}}};
    body.materials = {{1, felt_tissue}, {lump, felt_tissue}};
    body.materials[1].material.youngs_modulus *= factor;
    return condensed_body(std::move(body), test::no_progress);
}

constexpr double tool = 3;  // mm

Feel feel_with_lump(double low, double high, double factor) {
    return feel_of(block_with_lump(low, high, factor), tool, 1);
}

double contrast_with_lump(double low, double high, double factor) {
    return contrast_of(feel_with_lump(low, high, factor).regions.at(0));
}

// A sphere of half an element on a block of 20 elements: the load's disc, 2.5 elements wide, gives way by
// less than on a half-space because the block is held and ends, which is a tenth of the depth.
TEST(Feel, stiffness_of_a_large_block_is_that_of_hertz) {
    const DeformableBody body =
        condensed_body(test::held_block({20, 20, 12}, {60, 60, 36}, felt_tissue), test::no_progress);
    constexpr double radius = 1.5, depth = 3, rim = 15, edges = 0.1;
    const Feel feel = feel_of(body, radius, 2);
    EXPECT_EQ(feel.depth, depth);
    EXPECT_TRUE(feel.regions.empty());
    const double modulus =
        felt_tissue.youngs_modulus / (1 - felt_tissue.poissons_ratio * felt_tissue.poissons_ratio);
    const double hertz = 4.0 / 3 * modulus * std::sqrt(radius * depth);  // F / d
    std::size_t inner = 0;
    for (std::size_t v = 0; v < feel.stiffness.size(); ++v) {
        const Vector3d& p = body.boundary.surface.vertices[v];
        if (p.z() < 36 || p.x() < rim || p.x() > 60 - rim || p.y() < rim || p.y() > 60 - rim) continue;
        ++inner;
        EXPECT_NEAR(static_cast<double>(feel.stiffness[v]) / hertz, 1, edges) << p.transpose();
    }
    EXPECT_GT(inner, 100U);
}

TEST(Feel, what_cannot_move_cannot_be_pressed) {
    const DeformableBody body = block_with_lump(8, 16, 5);
    const Feel feel = feel_of(body, tool, 1);
    for (std::size_t v = 0; v < feel.stiffness.size(); ++v)
        EXPECT_EQ(feel.stiffness[v] > 0, body.boundary.surface.vertices[v].z() > 0) << v;
}

TEST(Feel, a_region_of_the_material_around_it_changes_nothing) {
    const FeltRegion felt = feel_with_lump(8, 20, 1).regions.at(0);
    EXPECT_EQ(felt.region, lump);
    EXPECT_NEAR(contrast_of(felt), 0, felt_rounding);
    EXPECT_EQ(verdict_of(felt, 3), FeltVerdict::too_faint);
}

TEST(Feel, a_stiffer_or_nearer_or_larger_region_changes_more) {
    const double as_it_is = contrast_with_lump(8, 16, 4);
    EXPECT_GT(as_it_is, 0);
    EXPECT_GT(contrast_with_lump(8, 16, 8), as_it_is);
    EXPECT_GT(contrast_with_lump(12, 20, 4), as_it_is);
    EXPECT_GT(contrast_with_lump(4, 16, 4), as_it_is);
    EXPECT_LT(contrast_with_lump(8, 16, 0.25), 0);
}

TEST(Feel, a_region_is_felt_best_where_it_is_nearest) {
    const DeformableBody body = block_with_lump(12, 20, 6);
    const FeltRegion felt = feel_of(body, tool, 1).regions.at(0);
    const Vector3d place = body.boundary.surface.vertices[static_cast<std::size_t>(felt.vertex)];
    EXPECT_EQ(place.z(), top);
    EXPECT_LT(std::hypot(place.x() - 20, place.y() - 20), 6);
    EXPECT_NEAR(felt.depth, 4, 1e-9);  // a layer of elements
}

TEST(Feel, stiffness_without_a_region_is_that_of_a_body_condensed_without_it) {
    const FeltRegion felt = feel_with_lump(12, 20, 6).regions.at(0);
    const Feel without = feel_with_lump(12, 20, 1);
    EXPECT_NEAR(felt.stiffness_without /
                    static_cast<double>(without.stiffness[static_cast<std::size_t>(felt.vertex)]),
                1, felt_rounding);
}

TEST(Feel, is_the_same_at_any_number_of_threads_and_of_a_compressed_compliance_to_its_accuracy) {
    DeformableBody body = block_with_lump(12, 20, 6);
    const Feel one = feel_of(body, tool, 1), three = feel_of(body, tool, 3);
    EXPECT_EQ(one.stiffness, three.stiffness);
    EXPECT_EQ(one.regions.at(0).stiffness_without, three.regions.at(0).stiffness_without);
    constexpr double accuracy = 1e-3;
    body.compliance = condense_hierarchically(body, accuracy, 1, test::no_progress);
    const Feel compressed = feel_of(body, tool, 1);
    for (std::size_t v = 0; v < one.stiffness.size(); ++v)
        EXPECT_NEAR(compressed.stiffness[v], one.stiffness[v],
                    accuracy * static_cast<double>(one.stiffness[v]));
}

TEST(Feel, trials_tell_what_a_region_condensed_anew_would_be) {
    DeformableBody body = block_with_lump(8, 16, 3);
    body.feel = feel_of(body, tool, 1);
    const FeltRegion felt = body.feel->regions.at(0);
    const std::vector<FeltTrial> trials = felt_trials(body, felt, 1);
    ASSERT_GE(trials.size(), 4U);
    EXPECT_EQ(trials[0].change, "2 times as stiff");
    EXPECT_NEAR(
        trials[0].felt.stiffness /
            static_cast<double>(feel_with_lump(8, 16, 6).stiffness[static_cast<std::size_t>(felt.vertex)]),
        1, felt_rounding);
    EXPECT_EQ(trials[1].change, "half as deep");
    EXPECT_EQ(trials[2].change, "1.5 times as large");
    for (const std::size_t geometric : {1, 2})
        EXPECT_GT(contrast_of(trials[geometric].felt), contrast_of(felt)) << trials[geometric].change;
    EXPECT_EQ(trials[3].change, "a tool of 1.5 mm radius");
    EXPECT_LT(contrast_of(trials[3].felt), contrast_of(felt));
}

TEST(Feel, compliance_and_contact_nodes_must_belong_together) {
    DeformableBody body = block_with_lump(8, 16, 3);
    body.contact_nodes.pop_back();
    EXPECT_THROW(feel_of(body, tool, 1), InvalidInput);
}

// Hertz's circle fills what the law of the disc holds for, up to three discs of the mesh.
TEST(Pressing, spreads_over_the_wider_of_what_the_mesh_and_the_sphere_ask_for_within_bounds) {
    const DeformableBody body = block_with_lump(8, 16, 3);
    const double mesh_reach = spread_disc(body, pressing_of(body, 1, 1).blocks).reach;
    EXPECT_EQ(pressing_of(body, 1, 1).disc.reach, mesh_reach);
    EXPECT_NEAR(pressing_of(body, 15, 15).disc.reach, 1.533 * 15, 1e-12);
    EXPECT_EQ(pressing_of(body, 100, 100).disc.reach, 3 * mesh_reach);
}

}  // namespace
}  // namespace palpate
