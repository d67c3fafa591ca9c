// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cmath>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/model/label_map.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using ::testing::ElementsAre;

const std::vector<Label> abdomen{{.value = 1, .name = "Liver"},
                                 {.value = 2, .name = "liver"},
                                 {.value = 3, .name = "left kidney"},
                                 {.value = 4, .name = "2"},
                                 {.value = 9, .name = "spleen"}};

std::int32_t found(std::string_view key) {
    const auto label = find_label(abdomen, key);
    return label ? label->value : 0;
}

TEST(LabelMap, a_label_is_found_by_its_name_before_one_like_it_and_by_its_value_last) {
    EXPECT_EQ(found("liver"), 2);
    EXPECT_EQ(found("LIVER"), 1);
    EXPECT_EQ(found("Left_Kidney"), 3);
    EXPECT_EQ(found("2"), 4);
    EXPECT_EQ(found("9"), 9);
    for (const char* nothing : {"", "5", "9x", "-9", " 9", "kidney", "99999999999"})
        EXPECT_EQ(found(nothing), 0) << nothing;
    EXPECT_EQ(find_label(LabelMap{.grid = {}, .labels = {}, .names = abdomen}, "spleen")->value, 9);
}

TEST(LabelMap, the_nearest_names_are_three_at_most_best_first) {
    const std::vector<std::string> names{"spleen", "liver", "left kidney", "right kidney", "sliver"};
    EXPECT_THAT(nearest_names("lifer", names), ElementsAre("liver", "sliver", "spleen"));
    // What holds the word or is held by it comes before what is only spelt alike.
    EXPECT_THAT(nearest_names("KIDNEY", names), ElementsAre("left kidney", "right kidney", "liver"));
    EXPECT_THAT(nearest_names("spleens", {"spline", "spleen"}), ElementsAre("spleen", "spline"));
    EXPECT_THAT(nearest_names("a", {}), ElementsAre());
}

TEST(LabelMap, a_label_that_is_not_there_is_named_with_its_file_and_the_nearest) {
    EXPECT_EQ(require_label(abdomen, "spleen", "a.nrrd").value, 9);
    const LabelMap map{
        .grid = {}, .labels = {}, .names = {{.value = 1, .name = "liver"}, {.value = 2, .name = "rib"}}};
    EXPECT_EQ(sample::refusal([&] { require_label(map, "livr", "a.nrrd"); }),
              "a.nrrd: no label 'livr'; nearest names: 'liver', 'rib'");
    EXPECT_EQ(sample::refusal([] { require_label(LabelMap{}, "liver", "a.nrrd"); }),
              "a.nrrd: no label 'liver'; there are no labels; segment first");
}

TEST(LabelMap, two_labels_of_one_name_are_told_apart_by_value_alone) {
    const std::vector<Label> twice{
        {.value = 1, .name = "liver"}, {.value = 3, .name = "liver"}, {.value = 4, .name = "Liver"}};
    EXPECT_EQ(sample::refusal([&] { require_label(twice, "liver", "a.nrrd"); }),
              "a.nrrd: labels 1 and 3 are both 'liver' (expected one label of that name); name it by its "
              "value, or rename one where they were made");
    EXPECT_EQ(require_label(twice, "Liver", "a.nrrd").value, 4);
    EXPECT_EQ(require_label(twice, "3", "a.nrrd").value, 3);
}

TEST(LabelMap, default_colours_of_neighbouring_values_differ) {
    constexpr float seen = 0.1F;  // of a channel's whole
    constexpr std::int32_t count = 12;
    const auto distance = [](const std::array<float, 3>& a, const std::array<float, 3>& b) {
        return std::max({std::abs(a[0] - b[0]), std::abs(a[1] - b[1]), std::abs(a[2] - b[2])});
    };
    for (std::int32_t a = 1; a <= count; ++a) {
        for (const float channel : default_label_colour(a)) {
            EXPECT_GE(channel, 0) << a;
            EXPECT_LE(channel, 1) << a;
        }
        for (std::int32_t b = 1; b < a; ++b)
            EXPECT_GT(distance(default_label_colour(a), default_label_colour(b)), seen) << a << " " << b;
    }
    EXPECT_EQ(default_label_colour(5), default_label_colour(5));
}

}  // namespace
}  // namespace palpate
