// SPDX-License-Identifier: Apache-2.0
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/provenance/cautions.hpp"

namespace palpate::provenance {
namespace {

using ::testing::ElementsAre;
using ::testing::IsEmpty;

TEST(Cautions, come_from_the_case_its_meshes_and_its_image_in_turn) {
    EXPECT_THAT(
        cautions_in(
            R"({"notes": ["no HU"], "meshes": {"liver": {"at_image_edge": ["liver", "tumour"]}, "wall": {}},
                        "build": {"cautions": ["'tumour' is made up", "5 kPa is the case file's"]}})"),
        ElementsAre("'tumour' is made up", "5 kPa is the case file's",
                    "‘liver’ reaches the image’s edge: what lies beyond it is missing.",
                    "‘tumour’ reaches the image’s edge: what lies beyond it is missing.", "no HU"));
}

TEST(Cautions, are_none_where_a_provenance_is_silent_or_another) {
    for (const char* provenance :
         {"", "{", "7", "[]", "{}", R"({"build": 7, "notes": {"a": 1}, "meshes": ["liver"]})",
          R"({"build": {"cautions": [7, null, ["nested"]]}, "notes": "text", "meshes": {"liver": 3}})"})
        EXPECT_THAT(cautions_in(provenance), IsEmpty()) << provenance;
}

}  // namespace
}  // namespace palpate::provenance
