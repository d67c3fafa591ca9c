// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <nlohmann/json.hpp>

#include "formats/model/errors.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/tools/meshing/phantom.hpp"
#include "tools/meshing/contract/contract.hpp"
#include "tools/meshing/contract/contract_json.hpp"
#include "tools/meshing/contract/mesh_to_contract.hpp"

namespace palpate {
namespace {

using namespace meshing;

TEST(QualityContract, coarse_request_is_made_finer_until_it_is_kept) {
    const LabelMap map = test::organ_with_lesion();
    const MeshSizing coarse{.cell_size = 12, .facet_distance = 4};
    const QualityContract contract{.max_mean_distance = 0.06};
    const ContractedMesh once = mesh_to_contract(map, test::organ_and_lesion, coarse, contract, 1);
    ASSERT_FALSE(once.attempts.back().misses.empty());
    const ContractedMesh result = mesh_to_contract(map, test::organ_and_lesion, coarse, contract, 8);
    EXPECT_GT(result.attempts.size(), 1U);
    EXPECT_EQ(result.attempts.front().misses.size(), once.attempts.back().misses.size());
    EXPECT_TRUE(result.attempts.back().misses.empty()) << what_text(result.attempts.back().misses.front());
    EXPECT_GT(result.attempts.back().tetrahedra, once.attempts.back().tetrahedra);
}

TEST(QualityContract, any_direction_matrix_keeps_it) {
    Eigen::Matrix3d flipped = Eigen::Vector3d(-1, 1, -1).asDiagonal(), permuted;
    permuted << 0, 0, -1, 1, 0, 0, 0, 1, 0;
    const Eigen::Matrix3d oblique =
        Eigen::AngleAxisd(0.6, Eigen::Vector3d(3, -1, 2).normalized()).toRotationMatrix();
    for (const Eigen::Matrix3d& direction : {flipped, permuted, oblique}) {
        const LabelMap map = test::organ_with_lesion(direction);
        const ContractedMesh result = mesh_to_contract(map, test::organ_and_lesion, {.cell_size = 4}, {}, 4);
        EXPECT_TRUE(result.attempts.back().misses.empty())
            << what_text(result.attempts.back().misses.front());
    }
}

TEST(QualityContract, impossible_limit_is_named_after_the_last_attempt) {
    const LabelMap map = test::organ_with_lesion();
    QualityContract contract;
    contract.min_region_dice = 0.99999;
    const ContractedMesh result =
        mesh_to_contract(map, test::organ_and_lesion, {.cell_size = 6}, contract, 2);
    ASSERT_EQ(result.attempts.size(), 2U);
    const auto& missed = result.attempts.back().misses;
    ASSERT_EQ(missed.size(), 2U);
    EXPECT_EQ(missed[1].name, "min_region_dice");
    EXPECT_EQ(missed[1].region_name, "lesion");
    EXPECT_EQ(missed[1].limit, 0.99999);
}

// A mesh of one region whose measures are set by hand.
struct HandMade {
    TetMesh mesh;
    MeshMeasures measures;
    ImageGrid grid;
};

HandMade sound() {
    HandMade made;
    made.mesh.rest_positions = {{0, 0, 0}, {4, 0, 0}, {0, 3, 0}, {0, 0, 2}};
    made.mesh.tetrahedra = {{0, 1, 2, 3}};
    made.mesh.regions = {4};
    made.mesh.region_names = {{4, "organ"}};
    made.measures.quality.min_dihedral_deg = 40;
    made.measures.quality.max_dihedral_deg = 100;
    made.measures.quality.worst = {{0, 40, 100, {1, 2, 3}}};
    made.measures.fidelity.body = {0, 4, 0.1, 0.99, 0.01};
    made.measures.fidelity.regions = {{4, 4, 0.1, 0.99, 0.01}};
    made.measures.distances.resize(1);
    made.measures.distances[0].region = 4;
    made.measures.components = {{4, 4, {1, 1, 1}, 0.9}};
    return made;
}

TEST(ContractMisses, sound_mesh_has_none) {
    const HandMade made = sound();
    EXPECT_TRUE(misses(check_shape({}, made.mesh, made.measures.quality)).empty());
    EXPECT_TRUE(misses(check_fidelity({}, made.mesh, made.measures, made.grid)).empty());
}

TEST(ContractMisses, flat_tetrahedron_is_named_with_its_place_and_size) {
    HandMade made = sound();
    made.measures.quality.max_dihedral_deg = made.measures.quality.worst[0].max_dihedral_deg = 165.5;
    const auto missed = misses(check_shape({}, made.mesh, made.measures.quality));
    ASSERT_EQ(missed.size(), 1U);
    EXPECT_EQ(what_text(missed[0]), "the largest dihedral angle");
    EXPECT_EQ(value_text(missed[0]), "165.5° at (1.0, 2.0, 3.0)");
    EXPECT_EQ(limit_text(missed[0]), "at most 165°");
    EXPECT_EQ(missed[0].places.at(0), Eigen::Vector3d(1, 2, 3));
    EXPECT_DOUBLE_EQ(missed[0].size, 5);
}

TEST(ContractMisses, broken_boundary_and_inverted_tetrahedra_are_always_misses) {
    HandMade made = sound();
    made.measures.quality.inverted = 1;
    made.measures.quality.boundary.non_manifold_edges = 2;
    made.measures.quality.boundary.open_edges = 3;
    EXPECT_EQ(misses(check_shape({}, made.mesh, made.measures.quality)).size(), 3U);
}

TEST(ContractMisses, boundary_that_cuts_through_itself_is_one) {
    HandMade made = sound();
    made.mesh = sample::cube_mesh(2, 10);
    EXPECT_TRUE(misses(check_shape({}, made.mesh, made.measures.quality)).empty());
    const auto top = std::ranges::find(made.mesh.rest_positions, Eigen::Vector3d(5, 5, 10));
    ASSERT_NE(top, made.mesh.rest_positions.end());
    top->z() = -1;
    const auto missed = misses(check_shape({}, made.mesh, made.measures.quality));
    ASSERT_EQ(missed.size(), 1U);
    EXPECT_EQ(missed[0].name, "boundary_cuts");
}

TEST(ContractMisses, every_limit_of_fidelity_is_checked) {
    const auto missed_by = [](const std::function<void(MeshMeasures&)>& spoil) {
        HandMade made = sound();
        spoil(made.measures);
        const auto missed = misses(check_fidelity({}, made.mesh, made.measures, made.grid));
        return missed.size() == 1 ? what_text(missed[0]) + " is " + value_text(missed[0])
                                  : std::string("misses: ") + std::to_string(missed.size());
    };
    EXPECT_EQ(missed_by([](MeshMeasures& m) { m.fidelity.body.dice = 0.97; }),
              "the Dice coefficient of the body is 0.9700");
    EXPECT_EQ(missed_by([](MeshMeasures& m) { m.fidelity.body.centroid_distance = 0.06; }),
              "the centroid's distance of the body is 0.060 mm");
    EXPECT_EQ(missed_by([](MeshMeasures& m) { m.fidelity.regions[0].volume_error_percent = -1.1; }),
              "the volume error of 'organ' is -1.100 %");
    EXPECT_EQ(missed_by([](MeshMeasures& m) { m.fidelity.regions[0].dice = 0.94; }),
              "the Dice coefficient of 'organ' is 0.9400");
    EXPECT_EQ(missed_by([](MeshMeasures& m) { m.distances[0].mean = 0.26; }),
              "the mean surface distance of 'organ' is 0.260 mm");
    EXPECT_EQ(missed_by([](MeshMeasures& m) { m.distances[0].percentile_95 = 0.51; }),
              "the 95th percentile of the surface distance of 'organ' is 0.510 mm");
    EXPECT_EQ(missed_by([](MeshMeasures& m) { m.distances[0].maximum = 1.8; }),
              "the largest surface distance of 'organ' is 1.800 mm at (0.0, 0.0, 0.0)");
    EXPECT_EQ(missed_by([](MeshMeasures& m) { m.components[0].covered = 0.4; }),
              "the share of the component of 4 mm³ of 'organ' is 40.000 % at (1.0, 1.0, 1.0)");
}

TEST(ContractMisses, a_tetrahedron_too_flat_both_ways_is_made_finer_at_one_place) {
    HandMade made = sound();
    made.measures.quality.min_dihedral_deg = made.measures.quality.worst[0].min_dihedral_deg = 5;
    made.measures.quality.max_dihedral_deg = made.measures.quality.worst[0].max_dihedral_deg = 170;
    const auto missed = misses(check_shape({}, made.mesh, made.measures.quality));
    ASSERT_EQ(missed.size(), 2U);
    EXPECT_EQ(missed[0].name, "min_dihedral_deg");
    EXPECT_EQ(missed[0].value, 5);
    EXPECT_EQ(missed[1].places, missed[0].places);
    EXPECT_EQ(missed[1].size, missed[0].size);
}

TEST(ContractChecks, are_numbers_in_json_and_back) {
    HandMade made = sound();
    made.measures.distances[0].maximum = std::numeric_limits<double>::infinity();
    auto checks = check_fidelity({}, made.mesh, made.measures, made.grid);
    const auto shape = check_shape({}, made.mesh, made.measures.quality);
    checks.insert(checks.end(), shape.begin(), shape.end());
    for (const ContractCheck& check : checks) {
        const auto json = nlohmann::ordered_json::parse(to_json(check).dump());
        EXPECT_TRUE(json["limit"].is_number()) << json;
        const auto read = contract_check_from(json);
        ASSERT_TRUE(read) << json;
        EXPECT_EQ(read->value, check.value) << json;
        EXPECT_EQ(read->met, check.met);
        EXPECT_EQ(what_text(*read) + value_text(*read) + limit_text(*read),
                  what_text(check) + value_text(check) + limit_text(check));
    }
    EXPECT_FALSE(contract_check_from({{"what", "the volume error"}, {"found", "1 %"}}));
}

TEST(ContractMisses, limits_grow_with_coarse_voxels_alone) {
    HandMade made = sound();
    made.measures.distances[0].mean = 0.6;
    made.grid.spacing = {3, 3, 3};
    EXPECT_TRUE(misses(check_fidelity({}, made.mesh, made.measures, made.grid)).empty());
    made.grid.spacing = {0.5, 0.5, 0.5};
    EXPECT_EQ(misses(check_fidelity({}, made.mesh, made.measures, made.grid)).size(), 1U);
}

}  // namespace
}  // namespace palpate
