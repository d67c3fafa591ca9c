// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "runtime/visual/pictures.hpp"

namespace palpate {
namespace {

TEST(Pictures, get_the_first_number_that_is_free) {
    const auto folder =
        std::filesystem::temp_directory_path() / ("palpate_pictures_" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    EXPECT_EQ(visual::free_picture_path(folder, "liver").filename(), "palpate-liver-1.png");
    std::ofstream(folder / "palpate-liver-1.png") << "taken";
    EXPECT_EQ(visual::free_picture_path(folder, "liver").filename(), "palpate-liver-2.png");
    std::filesystem::remove_all(folder);
}

TEST(Pictures, stay_in_their_folder_whatever_the_case_is_called) {
    EXPECT_EQ(visual::free_picture_path("nowhere", "../a case").string(), "nowhere/palpate-___a_case-1.png");
}

}  // namespace
}  // namespace palpate
