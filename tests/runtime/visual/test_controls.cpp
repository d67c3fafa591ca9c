// SPDX-License-Identifier: Apache-2.0
#include <fstream>
#include <gtest/gtest.h>
#include <set>
#include <unistd.h>
#include <vtkNew.h>

#include "runtime/visual/controls/free_path.hpp"
#include "runtime/visual/controls/open_window.hpp"
#include "runtime/visual/controls/view_history.hpp"
#include "runtime/visual/controls/window_keys.hpp"

namespace palpate {
namespace {

using visual::free_path;
using visual::ViewHistory;
using namespace std::chrono_literals;

TEST(FreePath, has_the_first_number_that_is_free) {
    const auto folder =
        std::filesystem::temp_directory_path() / ("palpate_pictures_" + std::to_string(getpid()));
    std::filesystem::create_directory(folder);
    EXPECT_EQ(free_path(folder, "liver", ".png").filename(), "palpate-liver-1.png");
    std::ofstream(folder / "palpate-liver-1.png") << "taken";
    EXPECT_EQ(free_path(folder, "liver", ".png").filename(), "palpate-liver-2.png");
    EXPECT_EQ(free_path(folder, "liver", ".h5").filename(), "palpate-liver-1.h5");
    std::filesystem::remove_all(folder);
}

TEST(FreePath, stays_in_its_folder_whatever_the_case_is_called) {
    EXPECT_EQ(free_path("nowhere", "../a case", ".png").string(), "nowhere/palpate-___a_case-1.png");
}

TEST(WindowKeys, have_one_meaning_each_and_none_that_an_exercise_or_the_hand_has) {
    std::set<std::string_view> taken{"m",     "e",      "n",         "w",    "s",
                                     "space", "return", "backspace", "plus", "minus"};
    for (const visual::WindowKey& entry : visual::window_keys()) {
        EXPECT_TRUE(taken.insert(entry.key).second) << entry.key;
        EXPECT_FALSE(std::string_view(entry.label).empty());
        EXPECT_FALSE(std::string_view(entry.tip).empty());
    }
}

TEST(WindowSize, suits_the_display) {
    using Size = visual::WindowSize;
    EXPECT_EQ(visual::usual_window_size(1920, 1080), (Size{1280, 720}));
    EXPECT_EQ(visual::usual_window_size(3840, 2160), (Size{2560, 1440}));
    EXPECT_EQ(visual::usual_window_size(3840, 1080), (Size{1280, 720})) << "two displays";
    EXPECT_EQ(visual::usual_window_size(1024, 600), (Size{1024, 600}));
}

TEST(ViewHistory, goes_back_through_what_was_left_and_no_further) {
    ViewHistory history;
    vtkNew<vtkCamera> camera;
    const auto put = [&](double x) { camera->SetPosition(x, 0, 0); };
    EXPECT_FALSE(history.back(camera));
    const auto start = ViewHistory::Clock::now();
    put(1);
    history.keep(camera, start);
    put(2);
    history.keep(camera, start + 5s);
    put(3);
    EXPECT_TRUE(history.back(camera));
    EXPECT_EQ(camera->GetPosition()[0], 2);
    EXPECT_TRUE(history.back(camera));
    EXPECT_EQ(camera->GetPosition()[0], 1);
    EXPECT_FALSE(history.back(camera));
}

TEST(ViewHistory, takes_what_follows_within_a_second_for_one_change) {
    ViewHistory history;
    vtkNew<vtkCamera> camera;
    const auto start = ViewHistory::Clock::now();
    for (int notch = 0; notch < 5; ++notch) {
        camera->SetPosition(notch, 0, 0);
        history.keep(camera, start + notch * 300ms);
    }
    EXPECT_TRUE(history.back(camera));
    EXPECT_EQ(camera->GetPosition()[0], 0);
    EXPECT_FALSE(history.back(camera));
}

TEST(ViewHistory, forgets_the_oldest_of_many) {
    ViewHistory history;
    vtkNew<vtkCamera> camera;
    auto now = ViewHistory::Clock::now();
    for (int view = 0; view < 60; ++view, now += 2s) {
        camera->SetPosition(view, 0, 0);
        history.keep(camera, now);
    }
    int kept = 0;
    while (history.back(camera)) ++kept;
    EXPECT_EQ(kept, 50);
    EXPECT_EQ(camera->GetPosition()[0], 10);
}

}  // namespace
}  // namespace palpate
