// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>
#include <limits>
#include <numbers>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/sound_tetrahedra.hpp"
#include "formats/model/errors.hpp"
#include "tests/tools/fem/blocks.hpp"

namespace palpate {
namespace {

constexpr double degree = std::numbers::pi / 180;

TetMesh single(const std::array<Eigen::Vector3d, 4>& points) {
    TetMesh mesh;
    mesh.rest_positions.assign(points.begin(), points.end());
    mesh.tetrahedra = {{0, 1, 2, 3}};
    mesh.regions = {1};
    if (six_volume(mesh, 0) < 0) std::swap(mesh.tetrahedra[0][2], mesh.tetrahedra[0][3]);
    return mesh;
}

// A direction, by its angles from the x axis in the xy plane and out of that plane.
Eigen::Vector3d direction(double in_plane, double out_of_plane) {
    return {std::cos(in_plane) * std::cos(out_of_plane), std::sin(in_plane) * std::cos(out_of_plane),
            std::sin(out_of_plane)};
}

ErrorDetail refusal(const TetMesh& mesh) {
    try {
        discretise(mesh, ElementOrder::linear, {});
    } catch (const InvalidInput& error) {
        return error.detail();
    }
    return {};
}

TEST(SoundTetrahedra, quality_is_one_for_a_regular_tetrahedron_at_any_size) {
    for (const double size : {1e-3, 1.0, 1e3})
        EXPECT_NEAR(
            element_quality(
                single({Eigen::Vector3d{0, 0, 0}, {size, size, 0}, {size, 0, size}, {0, size, size}}), 0),
            1, 1e-14);
}

TEST(SoundTetrahedra, thin_ones_with_angles_of_one_degree_pass) {
    const double h = std::tan(0.5 * degree);
    // All four dihedral angles at the rim of a square that is folded by two half degrees.
    EXPECT_EQ(refusal(single({Eigen::Vector3d{1, 0, h / std::numbers::sqrt2},
                              {-1, 0, h / std::numbers::sqrt2},
                              {0, 1, -h / std::numbers::sqrt2},
                              {0, -1, -h / std::numbers::sqrt2}}))
                  .culprit,
              "");
    // A needle with 1 degree between the edges at its tip.
    EXPECT_EQ(refusal(single({Eigen::Vector3d{0, 0, 0}, direction(0, 0), direction(1 * degree, 0),
                              direction(0.5 * degree, 0.866 * degree)}))
                  .culprit,
              "");
    // Both: edges 1 degree apart at the tip, and faces 1 degree apart along them.
    EXPECT_EQ(refusal(single({Eigen::Vector3d{0, 0, 0}, direction(0, 0), direction(2 * degree, 0),
                              direction(1 * degree, 1 * degree * degree)}))
                  .culprit,
              "");
}

TEST(SoundTetrahedra, a_flat_one_is_refused_with_its_nodes_place_and_quality) {
    auto mesh = test::block_mesh({2, 2, 2}, {200, 200, 200});
    // Its last node comes a ten-millionth of an edge above the middle of the face between the others.
    Tetrahedron& flat = mesh.tetrahedra[7];
    const auto corner = [&](std::size_t c) { return mesh.rest_positions[static_cast<std::size_t>(flat[c])]; };
    const Eigen::Vector3d middle = (corner(0) + corner(1) + corner(2)) / 3;
    mesh.rest_positions.emplace_back(middle + 1e-7 * (corner(3) - middle));
    flat[3] = 27;
    const ErrorDetail detail = refusal(mesh);
    EXPECT_EQ(detail.culprit, "tetrahedron 7");
    EXPECT_NE(detail.found.find("flat"), std::string::npos) << detail.found;
    EXPECT_NE(detail.found.find(" and 27 around (166.7, 33.33, 33.33) mm"), std::string::npos)
        << detail.found;
    EXPECT_NE(detail.found.find("quality 2.7e-08"), std::string::npos) << detail.found;
    EXPECT_NE(detail.next_step.find("palpate mesh"), std::string::npos);
}

TEST(SoundTetrahedra, an_inverted_one_is_refused_by_its_number) {
    auto mesh = test::block_mesh({1, 1, 1}, {1, 1, 1});
    std::swap(mesh.tetrahedra[3][0], mesh.tetrahedra[3][1]);
    const ErrorDetail detail = refusal(mesh);
    EXPECT_EQ(detail.culprit, "tetrahedron 3");
    EXPECT_NE(detail.found.find("inside out"), std::string::npos) << detail.found;
    EXPECT_NE(detail.next_step.find("exchange two of its nodes"), std::string::npos);
}

TEST(SoundTetrahedra, coinciding_nodes_and_coordinates_that_are_no_numbers_are_refused) {
    EXPECT_EQ(refusal(single({Eigen::Vector3d{1, 2, 3}, {1, 2, 3}, {1, 2, 3}, {1, 2, 3}})).culprit,
              "tetrahedron 0");
    EXPECT_EQ(refusal(single({Eigen::Vector3d{std::numeric_limits<double>::quiet_NaN(), 0, 0},
                              {1, 0, 0},
                              {0, 1, 0},
                              {0, 0, 1}}))
                  .culprit,
              "tetrahedron 0");
}

}  // namespace
}  // namespace palpate
