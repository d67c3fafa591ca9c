// SPDX-License-Identifier: GPL-3.0-or-later
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/certificate/claims.hpp"
#include "tools/fem/certificate/discretisation_error.hpp"
#include "tools/fem/certificate/linear_limits.hpp"

namespace palpate {
namespace {

using namespace fem;
using ::testing::ElementsAre;
using ::testing::IsEmpty;

std::vector<std::string> broken(const DeformableBody& body) {
    std::vector<std::string> figures;
    for (const Claim& claim : recheck_claims(body))
        if (!claim.holds) figures.push_back(claim.figure);
    return figures;
}

TEST(Claims, of_a_sound_certificate_hold) {
    DeformableBody dense = condensed_body(test::lumpy_block(), test::no_progress);
    dense.certificate.discretisation_error = estimate_discretisation_error(dense);
    set_linear_limits(dense.certificate, find_linear_limits(dense));
    EXPECT_THAT(broken(dense), IsEmpty());

    DeformableBody blocks = prepared_body(
        test::held_block({5, 5, 5}, {14, 14, 14}, {.youngs_modulus = 6e-3, .poissons_ratio = 0.45}));
    blocks.compliance = condense_hierarchically(blocks, 1e-3, 1, test::no_progress);
    blocks.certificate = certify(blocks, certificate_sample(blocks));
    EXPECT_THAT(broken(blocks), IsEmpty());
}

struct Lie {
    const char* figure;
    std::function<void(Certificate&)> tell;
};

void PrintTo(const Lie& lie, std::ostream* stream) {
    *stream << lie.figure;
}

class LyingCertificate : public ::testing::TestWithParam<Lie> {};

TEST_P(LyingCertificate, is_found_by_its_figure) {
    DeformableBody body = condensed_body(test::lumpy_block(), test::no_progress);
    body.certificate.discretisation_error = estimate_discretisation_error(body);
    set_linear_limits(body.certificate, find_linear_limits(body));
    GetParam().tell(body.certificate);
    EXPECT_THAT(broken(body), ElementsAre(GetParam().figure));
}

INSTANTIATE_TEST_SUITE_P(
    Each, LyingCertificate,
    ::testing::Values(Lie{"residual", [](Certificate& c) { c.residual = 0; }},
                      Lie{"residual", [](Certificate& c) { c.residual *= 0.4; }},
                      Lie{"residual", [](Certificate& c) { c.residual = -1; }},
                      Lie{"load_error", [](Certificate& c) { c.load_error = 0; }},
                      Lie{"contact_error", [](Certificate& c) { c.contact_error = 0; }},
                      Lie{"sampled_columns", [](Certificate& c) { c.sampled_columns = 1 << 30; }},
                      Lie{"sampled_loads", [](Certificate& c) { c.sampled_loads += 1; }},
                      Lie{"free_dofs", [](Certificate& c) { c.free_dofs *= 10; }},
                      Lie{"smallest_eigenvalue", [](Certificate& c) { c.smallest_eigenvalue *= 1.1; }},
                      Lie{"largest_eigenvalue", [](Certificate& c) { c.largest_eigenvalue *= 0.9; }},
                      Lie{"condition_number", [](Certificate& c) { c.condition_number = 1; }},
                      Lie{"smallest_patch_eigenvalue",
                          [](Certificate& c) { c.smallest_patch_eigenvalue *= 1.1; }},
                      Lie{"discretisation_error", [](Certificate& c) { c.discretisation_error /= 2; }},
                      Lie{"checked_strain", [](Certificate& c) { c.checked_strain *= 1.1; }},
                      Lie{"checked_depth", [](Certificate& c) { c.checked_depth *= 1.1; }},
                      Lie{"linear_force_error", [](Certificate& c) { c.linear_force_error = 0; }},
                      Lie{"linear_surface_error", [](Certificate& c) { c.linear_surface_error /= 2; }}),
    [](const auto& info) { return std::to_string(info.index) + "_" + info.param.figure; });

}  // namespace
}  // namespace palpate
