// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tools/fem/condensation/condense.hpp"
#include "tools/fem/gravity/posture.hpp"

namespace palpate {
namespace {

using namespace fem;
using Eigen::Vector3d;

constexpr double liver_density = 1060;                      // kg/m³
constexpr double weight_density = liver_density * 9.81e-9;  // N/mm³
constexpr Material soft_bar{.youngs_modulus = 6e-3, .poissons_ratio = 0};

// 20 mm wide, held at z = 0.
DeformableBody bar(ElementOrder order, int cells = 3) {
    DeformableBody body = test::held_block({cells, cells, 3 * cells}, {20, 20, 60}, soft_bar);
    body.mesh.region_names = {{.value = 1, .name = "liver"}};
    body.element_order = order;
    return prepared_body(std::move(body));
}

Vector3d gravity(const std::string& posture) {
    return gravity_in(posture, "posture");
}

// u(z) = rho g / E (l z - z²/2) of a bar that hangs along its length, for Poisson's ratio 0.
double worst_of_hanging_bar(ElementOrder order, int cells) {
    const DeformableBody body = bar(order, cells);
    const auto u =
        displacements_under(body, std::vector<RegionDensity>{{1, liver_density}}, gravity("0,0,1"));
    const double whole = weight_density / soft_bar.youngs_modulus * 60 * 60 / 2;
    double worst = 0;
    for (std::size_t node = 0; node < u.size(); ++node) {
        const double z = body.mesh.rest_positions[node].z();
        const Vector3d exact(0, 0, weight_density / soft_bar.youngs_modulus * (60 * z - z * z / 2));
        worst = std::max(worst, (u[node] - exact).norm() / whole);
    }
    return worst;
}

TEST(Posture, a_bar_hangs_as_the_theory_of_rods_says) {
    EXPECT_LT(worst_of_hanging_bar(ElementOrder::quadratic, 3), 1e-9) << "whose displacements are quadratic";
    EXPECT_LT(worst_of_hanging_bar(ElementOrder::linear, 3), 0.15);
    EXPECT_LT(worst_of_hanging_bar(ElementOrder::linear, 6), 0.15 / 2) << "and converges";
}

TEST(Posture, the_same_posture_moves_nothing_and_the_opposite_one_twice_the_weight) {
    DeformableBody body = bar(ElementOrder::linear);
    const std::vector<RegionDensity> density{{1, liver_density}};
    const auto none = displacements_under(body, density, gravity("supine") - gravity("supine"));
    EXPECT_EQ(move_at_rest(body, none).largest_displacement, 0);
    const auto over = displacements_under(body, density, gravity("prone") - gravity("supine"));
    const auto up = displacements_under(body, density, gravity("prone"));
    for (std::size_t node = 0; node < up.size(); ++node)
        ASSERT_LT((over[node] - 2 * up[node]).norm(), 1e-9 * (1 + up[node].norm()));
}

TEST(Posture, mesh_and_surface_move_and_say_how_far) {
    DeformableBody body = bar(ElementOrder::linear);
    const auto before = body.mesh.rest_positions;
    const auto u =
        displacements_under(body, std::vector<RegionDensity>{{1, liver_density}}, gravity("0,0,1"));
    const Sag sag = move_at_rest(body, u);
    double farthest = 0;
    for (const Vector3d& one : u) farthest = std::max(farthest, one.norm());
    EXPECT_EQ(sag.largest_displacement, farthest);
    EXPECT_NEAR(sag.largest_stretch, weight_density / soft_bar.youngs_modulus * 60, 0.02)
        << "where it is held";
    for (std::size_t k = 0; k < body.boundary.nodes.size(); ++k) {
        const auto node = static_cast<std::size_t>(body.boundary.nodes[k]);
        EXPECT_EQ(body.boundary.surface.vertices[k], before[node] + u[node]);
    }
}

TEST(Posture, words_and_directions_say_where_gravity_points) {
    EXPECT_EQ(gravity("supine"), Vector3d(0, 9.81, 0)) << "posterior, on whose back it lies";
    EXPECT_EQ(gravity("left_side"), Vector3d(9.81, 0, 0));
    EXPECT_EQ(gravity("upright"), Vector3d(0, 0, -9.81));
    EXPECT_LT((gravity("0,3,-4") - 9.81 * Vector3d(0, 0.6, -0.8)).norm(), 1e-12);
    for (const char* wrong : {"sitting", "0,0,0", "1,2", "1,2,3,4", "nan,0,1"})
        EXPECT_THROW(gravity(wrong), UsageError) << wrong;
}

TEST(Posture, what_cannot_sag_is_refused_with_its_culprit) {
    DeformableBody body = bar(ElementOrder::linear);
    try {
        displacements_under(body, {}, gravity("prone"));
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("'liver'"), std::string::npos) << error.what();
    }
    const auto u =
        displacements_under(body, std::vector<RegionDensity>{{1, 30 * liver_density}}, gravity("0,0,-1"));
    try {
        move_at_rest(body, u);
        FAIL();
    } catch (const InvalidInput& error) {
        EXPECT_NE(std::string(error.what()).find("turns over"), std::string::npos) << error.what();
    }
}

}  // namespace
}  // namespace palpate
