// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>

#include "tests/formats/sample_case.hpp"
#include "tools/report/charts.hpp"
#include "tools/report/html.hpp"
#include "tools/report/verdict.hpp"

namespace palpate {
namespace {

using namespace report;

TEST(Html, base64_matches_rfc_4648) {
    for (const auto& [plain, coded] :
         {std::pair{"", ""}, {"f", "Zg=="}, {"fo", "Zm8="}, {"foo", "Zm9v"}, {"foobar", "Zm9vYmFy"}})
        EXPECT_EQ(html::data_uri("a/b", plain), std::string("data:a/b;base64,") + coded);
    EXPECT_EQ(html::data_uri("a/b", "\xff\xfe\xfd"), "data:a/b;base64,//79");
}

TEST(Html, groups_thousands) {
    EXPECT_EQ(html::grouped(0), "0");
    EXPECT_EQ(html::grouped(-999), "-999");
    EXPECT_EQ(html::grouped(1234567), "1\u202f234\u202f567");
    EXPECT_EQ(html::grouped(-123456), "-123\u202f456");
}

TEST(Charts, histogram_shows_each_bin_that_is_not_empty) {
    const std::string svg = histogram_svg({0, 4, {5, 0, 1'000'000, 1}}, "a < b", "°", 4);
    std::size_t bars = 0;
    for (std::size_t at = 0; (at = svg.find("<rect", at)) != std::string::npos; ++at) ++bars;
    EXPECT_EQ(bars, 3U);
    EXPECT_NE(svg.find("a &lt; b"), std::string::npos);
    EXPECT_EQ(svg.find("nan"), std::string::npos);
}

TEST(Charts, histogram_of_nothing_is_drawn_empty) {
    EXPECT_EQ(histogram_svg({0, 1, {0, 0}}, "x", "", 2).find("<rect"), std::string::npos);
}

TEST(Verdict, a_sound_body_passes_and_each_fault_is_found) {
    const DeformableBody body = sample::elastic_cube(2);
    const MeshSummary mesh = summarise(body.mesh);
    const auto all_hold = [](const std::vector<Check>& checks) {
        return std::ranges::all_of(checks, &Check::holds);
    };
    EXPECT_TRUE(all_hold(checks_of(body, mesh)));
    const auto fails_with = [&](auto fault) {
        DeformableBody broken = body;
        MeshSummary shape = mesh;
        fault(broken.certificate, shape);
        return !all_hold(checks_of(broken, shape));
    };
    EXPECT_TRUE(fails_with([](Certificate& c, MeshSummary&) { c.residual = 2e-6; }));
    DeformableBody sheet = body;
    sheet.certificate.contact_error = 3e-6;
    EXPECT_FALSE(all_hold(checks_of(sheet, mesh)));
    EXPECT_TRUE(all_hold(checks_of(sheet, mesh, AllowedLoadError{1e-6, 2e-5})));
    EXPECT_TRUE(fails_with([](Certificate& c, MeshSummary&) { c.asymmetry = 1e-9; }));
    EXPECT_TRUE(fails_with([](Certificate& c, MeshSummary&) { c.reciprocity = 1e-3; }));
    EXPECT_TRUE(fails_with([](Certificate& c, MeshSummary&) { c.smallest_eigenvalue = -1e-9; }));
    EXPECT_TRUE(fails_with([](Certificate& c, MeshSummary&) { c.sampled_columns = 0; }));
    EXPECT_TRUE(fails_with([](Certificate&, MeshSummary& m) { m.min_volume = -1; }));
    EXPECT_TRUE(fails_with([](Certificate&, MeshSummary& m) { m.min_dihedral_deg = 0; }));
}

TEST(Verdict, says_what_the_linear_answer_misses_or_that_nobody_looked) {
    DeformableBody body = sample::elastic_cube(2);
    const auto said = [&](const std::string& name) {
        const std::vector<Check> checks = checks_of(body, summarise(body.mesh));
        return std::ranges::find(checks, name, &Check::name)->value;
    };
    EXPECT_EQ(said("Strain up to which it was checked"), "25 %, 3.5 mm deep");
    EXPECT_EQ(said("Force missed there"), "6 %");
    EXPECT_EQ(said("Shape missed there"), "10 %");
    body.certificate = {};
    for (const char* name : {"Strain up to which it was checked", "Force missed there", "Shape missed there"})
        EXPECT_EQ(said(name), "not checked") << name;
}

}  // namespace
}  // namespace palpate
