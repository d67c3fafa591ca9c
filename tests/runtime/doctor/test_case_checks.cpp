// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "runtime/devices/device_model.hpp"
#include "runtime/doctor/checks/case_checks.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/doctor/made_up_machine.hpp"

namespace palpate {
namespace {

using namespace doctor;
using sample::find;
using ::testing::HasSubstr;

struct CaseChecks : testing::Test {
    Case patient_case = sample::sample_case();

    Findings check() const { return case_findings(patient_case); }
    void stretch(const Eigen::Vector3d& factors) {
        for (Eigen::Vector3d& p : patient_case.deformable_bodies[0].mesh.rest_positions)
            p = p.cwiseProduct(factors);
    }
};

TEST_F(CaseChecks, a_small_soft_case_suits_every_device) {
    const Findings findings = check();
    EXPECT_EQ(findings.size(), 2 * devices::device_models().size());
    EXPECT_EQ(count(findings, Level::ok), findings.size());
}

// The cube has an edge of 20 mm, and is held where z = 0.
TEST_F(CaseChecks, the_longest_edge_lies_along_the_longest_axis) {
    stretch({1, 1, 7.5});  // 20 x 20 x 75 (its free half) or 150 mm: longer than any but the longest axis
    EXPECT_EQ(find(check(), "workspace.touch").level, Level::ok);
}

TEST_F(CaseChecks, an_organ_that_is_thick_everywhere_is_too_large_for_a_touch_alone) {
    stretch({5, 5, 8});  // 100 x 100 x 80 (its free half) mm
    EXPECT_EQ(find(check(), "workspace.touch").level, Level::warning);
    EXPECT_THAT(find(check(), "workspace.touch").found, HasSubstr("wall"));
    EXPECT_EQ(find(check(), "workspace.desktop").level, Level::ok);
    EXPECT_EQ(find(check(), "workspace.premium").level, Level::ok);
}

TEST_F(CaseChecks, a_large_rigid_neighbour_is_only_worth_knowing) {
    for (Eigen::Vector3d& p : patient_case.rigid_bodies[0].surface.vertices) p *= 100;
    const Finding finding = find(check(), "workspace.touch");
    EXPECT_EQ(finding.level, Level::ok);
    EXPECT_THAT(finding.found, HasSubstr("is larger, and rigid"));
}

TEST_F(CaseChecks, more_stiffness_and_force_than_a_device_renders_are_told) {
    patient_case.haptics.coupling_stiffness = 0.9;
    patient_case.haptics.max_force = 8;
    EXPECT_EQ(find(check(), "rendering.touch").found,
              "0.9 N/mm and 8 N asked for, 0.5 N/mm and 3.3 N rendered");
    EXPECT_THAT(find(check(), "rendering.touch").fix, HasSubstr("max_force_n = 3.3"));
    EXPECT_THAT(find(check(), "rendering.desktop").found, HasSubstr("0.9 N/mm and 7.9 N rendered"));
}

}  // namespace
}  // namespace palpate
