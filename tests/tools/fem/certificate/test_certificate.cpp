// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <cstring>
#include <gtest/gtest.h>

#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/certificate/certificate.hpp"
#include "tools/fem/certificate/contact_loads.hpp"

namespace palpate {
namespace {

using namespace fem;
using Eigen::Index;
using Eigen::MatrixXd;

constexpr double as_stored = 1e-6;        // relative, of float32 columns
constexpr double eigenvalue_part = 0.02;  // estimates stop at 1 % of the largest
constexpr std::int32_t some_columns = 5, some_loads = 50;
constexpr std::uint64_t another_seed = 99;

DeformableBody dense_body() {
    return condensed_body(test::lumpy_block(), test::no_progress);
}

// A body of 300 contact nodes with a compressed compliance.
DeformableBody hierarchical_body() {
    DeformableBody body = prepared_body(
        test::held_block({7, 7, 7}, {14, 14, 14}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.45}));
    body.compliance = condense_hierarchically(body, 1e-3, 1, test::no_progress);
    return body;
}

Certificate rechecked(const DeformableBody& body) {
    return recertify(body, some_columns, some_loads, another_seed);
}

// The body with some entries of its dense compliance changed.
template <typename Change>
DeformableBody corrupted(DeformableBody body, const Change& change) {
    auto& dense = std::get<DenseCompliance>(body.compliance);
    const std::size_t n = dense.dof_count();
    std::shared_ptr<float[]> entries(new float[n * n]);
    std::memcpy(entries.get(), dense.entries.get(), n * n * sizeof(float));
    change(entries.get(), n);
    dense.entries = std::shared_ptr<const float>(entries, entries.get());
    return body;
}

TEST(Certificate, of_a_sound_body_is_clean) {
    const DeformableBody body = dense_body();
    const Certificate& c = body.certificate;
    EXPECT_LT(c.residual_double, 1e-10);
    EXPECT_LT(c.residual, as_stored);
    EXPECT_GT(c.residual, c.residual_double);
    EXPECT_EQ(c.asymmetry, 0);
    EXPECT_LT(c.reciprocity, 1e-6);  // products in float32
    EXPECT_LT(c.load_error, 1e-6);
    EXPECT_LT(c.contact_error, 1e-6);
    EXPECT_GT(c.smallest_patch_eigenvalue, 0);
    EXPECT_EQ(c.discretisation_error, -1);
    EXPECT_EQ(c.sampled_columns, certificate_columns);
    EXPECT_EQ(c.sampled_loads, certificate_loads);
    EXPECT_EQ(c.free_dofs,
              static_cast<std::int64_t>(3 * (body.mesh.rest_positions.size() - body.fixed_nodes.size())));
    EXPECT_DOUBLE_EQ(c.condition_number, c.largest_eigenvalue / c.smallest_eigenvalue);
}

TEST(Certificate, is_found_again_from_what_is_stored) {
    const DeformableBody body = dense_body();
    const Certificate again = rechecked(body);
    EXPECT_LT(again.residual, as_stored);
    EXPECT_LT(again.load_error, as_stored);
    EXPECT_EQ(again.sampled_columns, some_columns);
    EXPECT_EQ(again.sampled_loads, some_loads);
    EXPECT_EQ(again.free_dofs, body.certificate.free_dofs);
    EXPECT_NEAR(again.smallest_eigenvalue, body.certificate.smallest_eigenvalue,
                eigenvalue_part * body.certificate.smallest_eigenvalue);
    EXPECT_NEAR(again.largest_eigenvalue, body.certificate.largest_eigenvalue,
                eigenvalue_part * body.certificate.largest_eigenvalue);
}

TEST(Certificate, estimates_the_smallest_and_largest_eigenvalue) {
    for (const std::array<int, 3>& cells : {std::array{4, 3, 3}, std::array{3, 3, 12}}) {
        DeformableBody body = prepared_body(
            test::held_block(cells, {8, 6, 12}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.45}));
        const MatrixXd C = test::full(condense_by_trailing_block(body, test::no_progress));
        body = condensed_body(std::move(body), test::no_progress);
        const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(C).eigenvalues();
        const double smallest = values[0], largest = values[values.size() - 1];
        ASSERT_GT(smallest, 0);
        for (const Certificate& c : {body.certificate, rechecked(body)}) {
            EXPECT_NEAR(c.largest_eigenvalue, largest, eigenvalue_part * largest);
            EXPECT_NEAR(c.smallest_eigenvalue, smallest, eigenvalue_part * smallest);
            EXPECT_NEAR(c.condition_number, largest / smallest, 2 * eigenvalue_part * largest / smallest);
        }
    }
}

TEST(Certificate, finds_the_smallest_eigenvalue_of_a_body_without_free_nodes_inside) {
    DeformableBody body = prepared_body(
        test::held_block({3, 2, 1}, {3, 2, 1}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.3}));
    const MatrixXd C = test::full(condense_by_trailing_block(body, test::no_progress));
    body = condensed_body(std::move(body), test::no_progress);
    const double smallest = Eigen::SelfAdjointEigenSolver<MatrixXd>(C).eigenvalues()[0];
    EXPECT_NEAR(body.certificate.smallest_eigenvalue, smallest, eigenvalue_part * smallest);
}

TEST(Certificate, catches_a_compliance_of_another_material) {
    DeformableBody body = dense_body();
    body.materials[0].material.youngs_modulus *= 1.01;
    const Certificate c = rechecked(body);
    EXPECT_GT(c.residual, 1e-3);
    EXPECT_GT(c.load_error, 1e-3);
    EXPECT_GT(c.contact_error, 1e-3);
}

TEST(Certificate, catches_a_compliance_of_other_elements) {
    DeformableBody body = dense_body();
    body.element_order = ElementOrder::quadratic;
    const Certificate c = rechecked(body);
    EXPECT_GT(c.residual, 1e-2);
    EXPECT_GT(c.load_error, 1e-2);
    EXPECT_GT(c.contact_error, 1e-2);
    EXPECT_GT(c.free_dofs, body.certificate.free_dofs);
}

TEST(Certificate, catches_one_corrupted_column_that_it_re_solves) {
    const DeformableBody body = dense_body();
    SampledColumns sample = certificate_sample(body);
    const auto column = static_cast<std::size_t>(sample.dofs[3]);
    const DeformableBody bad = corrupted(body, [&](float* entries, std::size_t n) {
        for (std::size_t i = 0; i < n; ++i) entries[i * n + column] *= 1.01F;
    });
    EXPECT_GT(certify(bad, sample).residual, 5e-3);
    EXPECT_LT(certify(body, sample).residual, as_stored);
    // Only in double: what is stored is sound.
    const MatrixXd C = test::full(condense_by_trailing_block(body, test::no_progress));
    sample.values = C(Eigen::all, sample.dofs);
    EXPECT_LT(certify(body, sample).residual_double, 1e-10);
    sample.values.col(3) *= 1.01;
    const Certificate c = certify(body, sample);
    EXPECT_GT(c.residual_double, 5e-3);
    EXPECT_LT(c.residual, as_stored);
}

TEST(Certificate, catches_one_corrupted_column_that_it_does_not_re_solve) {
    const DeformableBody body = dense_body();
    const SampledColumns sample = certificate_sample(body);
    Index spared = 0;
    while (std::ranges::find(sample.dofs, spared) != sample.dofs.end()) ++spared;
    const auto column = static_cast<std::size_t>(spared);
    // Of a row-major symmetric matrix, a product takes the row that a force acts on.
    const DeformableBody bad = corrupted(body, [&](float* entries, std::size_t n) {
        for (std::size_t i = 0; i < n; ++i) entries[column * n + i] *= 1.01F;
    });
    const Certificate c = certify(bad, sample);
    EXPECT_GT(c.load_error, 1e-3);
    EXPECT_GT(c.contact_error, 1e-3);
    EXPECT_GT(c.asymmetry, 1e-4);
    EXPECT_GT(c.reciprocity, 1e-5);
}

TEST(Certificate, catches_asymmetry_and_indefiniteness) {
    const DeformableBody bad = corrupted(dense_body(), [](float* entries, std::size_t n) {
        entries[5 * n + 3] *= 1.5F;
        entries[7 * n + 7] *= -1;
    });
    const Certificate c = rechecked(bad);
    EXPECT_GT(c.asymmetry, 0);
    EXPECT_EQ(c.smallest_eigenvalue, 0);
}

TEST(Certificate, catches_nodes_that_would_move_against_their_forces) {
    const std::size_t node = 20;
    const DeformableBody bad = corrupted(dense_body(), [&](float* entries, std::size_t n) {
        for (std::size_t axis = 0; axis < 3; ++axis)
            entries[(3 * node + axis) * n + 3 * node + axis] *= -0.1F;
    });
    EXPECT_LT(rechecked(bad).smallest_patch_eigenvalue, 0);
}

// Forces on both faces of a sheet nearly cancel, so that rounding is much of what is left.
TEST(Certificate, of_a_thin_sheet_is_allowed_what_rounding_makes_and_no_more) {
    const DeformableBody sheet = condensed_body(
        test::held_block({14, 1, 14}, {48, 2, 48}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.45}),
        test::no_progress);
    const auto allowed = [](const DeformableBody& body, const Certificate& c) {
        return allowed_load_error(body, {c.load_error, c.contact_error}, c.sampled_loads, another_seed);
    };
    const Certificate sound = recertify(sheet, some_columns, certificate_loads, another_seed);
    ASSERT_GT(sound.contact_error, 1e-6);
    EXPECT_LT(sound.contact_error, allowed(sheet, sound).contact);
    EXPECT_LE(sound.load_error, allowed(sheet, sound).surface);
    EXPECT_LT(allowed(sheet, sound).contact, 1e-4);
    const DeformableBody stiffer = corrupted(sheet, [](float* entries, std::size_t n) {
        for (std::size_t i = 0; i < n * n; ++i) entries[i] *= 0.999F;
    });
    const Certificate found = recertify(stiffer, some_columns, certificate_loads, another_seed);
    EXPECT_GT(found.contact_error, 5 * allowed(stiffer, found).contact);
    EXPECT_GT(found.load_error, 5 * allowed(stiffer, found).surface);
}

TEST(Certificate, of_any_other_body_is_allowed_what_it_was) {
    const DeformableBody body = dense_body();
    const LoadError allowed = allowed_load_error(body, {1e-7, 9e-7}, some_loads, another_seed);
    EXPECT_EQ(allowed.surface, 1e-6);
    EXPECT_EQ(allowed.contact, 1e-6);
}

TEST(HierarchicalCertificate, of_a_sound_body_is_clean) {
    const DeformableBody body = hierarchical_body();
    const Certificate c = rechecked(body);
    EXPECT_LT(c.load_error, 1e-3);  // its accuracy
    EXPECT_LT(c.contact_error, 1e-3);
    EXPECT_LT(c.residual, 1e-2);  // of single entries instead of norms
    EXPECT_EQ(c.asymmetry, 0);
    EXPECT_LT(c.reciprocity, 1e-6);
    EXPECT_GT(c.smallest_patch_eigenvalue, 0);
    const MatrixXd C = test::full(condense_by_trailing_block(body, test::no_progress));
    const Eigen::VectorXd values = Eigen::SelfAdjointEigenSolver<MatrixXd>(C).eigenvalues();
    EXPECT_NEAR(c.largest_eigenvalue, values[values.size() - 1], eigenvalue_part * values[values.size() - 1]);
    const Certificate made = certify(body, certificate_sample(body));
    EXPECT_NEAR(made.largest_eigenvalue, values[values.size() - 1],
                eigenvalue_part * values[values.size() - 1]);
    EXPECT_NEAR(made.smallest_eigenvalue, values[0], eigenvalue_part * values[0]);
}

TEST(HierarchicalCertificate, catches_one_corrupted_far_block) {
    DeformableBody body = hierarchical_body();
    auto& compliance = std::get<HierarchicalCompliance>(body.compliance);
    const auto low_rank = std::ranges::max_element(compliance.blocks, {}, &ComplianceBlock::rank);
    ASSERT_GT(low_rank->rank, 0);
    std::shared_ptr<float[]> values(new float[compliance.value_count]);
    std::memcpy(values.get(), compliance.values.get(), compliance.value_count * sizeof(float));
    for (std::int32_t k = 0; k < low_rank->rank; ++k) values[low_rank->values + k] *= 1.1F;
    compliance.values = std::shared_ptr<const float>(values, values.get());
    EXPECT_GT(rechecked(body).load_error, 3e-3);
}

TEST(HierarchicalCertificate, catches_a_compliance_of_another_material) {
    DeformableBody body = hierarchical_body();
    body.materials[0].material.youngs_modulus *= 1.01;
    EXPECT_GT(rechecked(body).load_error, 5e-3);
}

TEST(HierarchicalCertificate, catches_nodes_that_would_move_against_their_forces) {
    DeformableBody body = hierarchical_body();
    auto& compliance = std::get<HierarchicalCompliance>(body.compliance);
    // The first block along the first children: that of the first cluster with itself.
    const ComplianceBlock* block = compliance.blocks.data();
    while (block->first_child != 0) block = &compliance.blocks[static_cast<std::size_t>(block->first_child)];
    ASSERT_EQ(block->rank, ComplianceBlock::dense);
    const std::size_t size = 3 * static_cast<std::size_t>(compliance.begin(compliance.depth, 1) -
                                                          compliance.begin(compliance.depth, 0));
    std::shared_ptr<float[]> values(new float[compliance.value_count]);
    std::memcpy(values.get(), compliance.values.get(), compliance.value_count * sizeof(float));
    for (std::size_t i = 0; i < size * size; ++i) values[static_cast<std::size_t>(block->values) + i] *= -1;
    compliance.values = std::shared_ptr<const float>(values, values.get());
    EXPECT_LT(rechecked(body).smallest_patch_eigenvalue, 0);
}

}  // namespace
}  // namespace palpate
