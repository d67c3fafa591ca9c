// SPDX-License-Identifier: GPL-3.0-or-later
#include <cstring>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>

#include "formats/elasticity/plausible_compliance.hpp"
#include "formats/model/errors.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/elastic_cube.hpp"

namespace palpate {
namespace {

using elasticity::require_answers_of_mesh;

constexpr int cells = 4;
constexpr std::uint64_t draws = 20;  // of the random loads

// A row of C as a forger changes it: the matrix stays symmetric, so that no other check can see it.
void scale_row(float* entries, std::size_t n, std::size_t row, float factor) {
    for (std::size_t k = 0; k < n; ++k) {
        entries[row * n + k] *= factor;
        entries[k * n + row] *= factor;
    }
}

DeformableBody with_entries(DeformableBody body, const std::function<void(float*, std::size_t)>& change) {
    auto& dense = std::get<DenseCompliance>(body.compliance);
    const std::size_t n = dense.dof_count();
    const std::shared_ptr<float[]> entries(new float[n * n]);
    std::memcpy(entries.get(), dense.entries.get(), n * n * sizeof(float));
    change(entries.get(), n);
    dense.entries = std::shared_ptr<const float>(entries, entries.get());
    return body;
}

DeformableBody cube() {
    return sample::true_elastic_cube(cells);
}

TEST(PlausibleCompliance, of_a_true_inverse_is_taken_whatever_the_load) {
    const DeformableBody dense = cube(), blocks = sample::with_hierarchical_compliance(cube(), 3, 1e-2);
    for (std::uint64_t seed = 0; seed < draws; ++seed) {
        EXPECT_NO_THROW(require_answers_of_mesh(dense, "dense", seed));
        EXPECT_NO_THROW(require_answers_of_mesh(blocks, "blocks", seed));
    }
}

// By chance a node hardly moves under two loads, of which what is off is then a large part.
TEST(PlausibleCompliance, compressed_coarsely_is_taken_under_loads_that_hardly_move_a_node) {
    const DeformableBody coarse = sample::with_hierarchical_compliance(cube(), 3, 2e-2);
    for (std::uint64_t seed = 0; seed < 10 * draws; ++seed)
        EXPECT_NO_THROW(require_answers_of_mesh(coarse, "coarse", seed)) << seed;
}

TEST(PlausibleCompliance, names_the_node_that_is_off_and_by_how_much) {
    const DeformableBody body = with_entries(cube(), [](float* entries, std::size_t n) {
        for (std::size_t axis = 0; axis < 3; ++axis) scale_row(entries, n, 30 + axis, 2);
    });
    const auto worst = elasticity::worst_answer(body, 3);
    ASSERT_TRUE(worst);
    EXPECT_EQ(worst->contact_node, 10U);
    EXPECT_NEAR(worst->part(), 1, 0.5);  // twice as soft against others, four times against itself
}

TEST(PlausibleCompliance, that_answers_with_no_number_is_off_without_bound) {
    const DeformableBody body = with_entries(cube(), [](float* entries, std::size_t n) {
        for (std::size_t k = 0; k < n; ++k) entries[k] = k % 2 == 0 ? 3e38F : -3e38F;
    });
    EXPECT_EQ(elasticity::worst_answer(body, 3)->part(), std::numeric_limits<double>::infinity());
}

// Quadratic elements are solved on two levels; the cube's compliance is of linear ones, which are stiffer.
TEST(PlausibleCompliance, of_linear_elements_is_refused_where_quadratic_ones_are_said) {
    DeformableBody body = cube();
    body.element_order = ElementOrder::quadratic;
    for (std::uint64_t seed = 0; seed < draws; ++seed)
        EXPECT_THROW(require_answers_of_mesh(body, "forged", seed), InvalidInput) << seed;
}

struct Forgery {
    const char* name;
    std::function<DeformableBody()> make;
};

void PrintTo(const Forgery& forgery, std::ostream* stream) {
    *stream << forgery.name;
}

class ForgedCompliance : public ::testing::TestWithParam<Forgery> {};

TEST_P(ForgedCompliance, is_refused_whatever_the_load) {
    const DeformableBody body = GetParam().make();
    for (std::uint64_t seed = 0; seed < draws; ++seed)
        EXPECT_THROW(require_answers_of_mesh(body, "forged", seed), InvalidInput) << seed;
}

DeformableBody scaled(float factor) {
    return with_entries(cube(), [=](float* entries, std::size_t n) {
        for (std::size_t k = 0; k < n * n; ++k) entries[k] *= factor;
    });
}

// Next to 0.5 the stiffness is all but singular, and the gradients go on for 20 000 steps.
TEST(PlausibleCompliance, of_a_mesh_that_cannot_judge_it_is_refused) {
    DeformableBody body = cube();
    for (RegionMaterial& region : body.materials) region.material.poissons_ratio = 0.5 - 1e-16;
    EXPECT_FALSE(elasticity::worst_answer(body, 0));
    EXPECT_THROW(require_answers_of_mesh(body, "sound", 0), InvalidInput);
}

INSTANTIATE_TEST_SUITE_P(
    Each, ForgedCompliance,
    ::testing::Values(
        Forgery{"twice_as_soft", [] { return scaled(2); }},
        Forgery{"half_as_soft", [] { return scaled(0.5F); }},
        Forgery{"a_third_stiffer", [] { return scaled(0.75F); }},
        Forgery{"one_entry_huge",
                [] { return with_entries(cube(), [](float* e, std::size_t) { e[0] = 1e30F; }); }},
        Forgery{"a_stiff_node",
                [] {
                    return with_entries(cube(), [](float* entries, std::size_t n) {
                        for (std::size_t axis = 0; axis < 3; ++axis) scale_row(entries, n, 30 + axis, 0.1F);
                    });
                }},
        // Its own displacements are as large as one likes, and must hide nothing of the others'.
        Forgery{"a_soft_corner_beside_a_stiff_organ",
                [] {
                    DeformableBody body = with_entries(cube(), [](float* entries, std::size_t n) {
                        for (std::size_t k = 3 * n; k < n * n; ++k) entries[k] *= 0.5F;
                    });
                    body.mesh.regions[0] = 3;
                    body.materials.push_back({3, {1e-12, 0.45}});
                    return body;
                }},
        Forgery{"springs_that_pull",
                [] {
                    return with_entries(cube(), [](float* entries, std::size_t n) {
                        for (std::size_t i = 0; i < n; ++i)
                            for (std::size_t j = 0; j < n; ++j)
                                if (i / 3 != j / 3) entries[i * n + j] *= -1;
                    });
                }},
        Forgery{"an_organ_that_is_held_elsewhere",
                [] {
                    DeformableBody body = cube();
                    body.fixed_nodes.resize(body.fixed_nodes.size() / 2);
                    return body;
                }},
        Forgery{"another_modulus",
                [] {
                    DeformableBody body = cube();
                    for (RegionMaterial& region : body.materials) region.material.youngs_modulus *= 1.5;
                    return body;
                }},
        Forgery{"another_place_of_a_node",
                [] {
                    DeformableBody body = cube();
                    for (Eigen::Vector3d& p : body.mesh.rest_positions) p *= 1.5;
                    return body;
                }}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(PlausibleCompliance, says_which_node_moves_otherwise) {
    try {
        require_answers_of_mesh(scaled(2), "liver.vtkhdf: compliance of liver", 1);
        FAIL() << "nothing was thrown";
    } catch (const InvalidInput& error) {
        EXPECT_THAT(error.what(), ::testing::HasSubstr("liver.vtkhdf: compliance of liver: is off by"));
        EXPECT_THAT(error.what(), ::testing::HasSubstr("build the case again"));
    }
}

}  // namespace
}  // namespace palpate
