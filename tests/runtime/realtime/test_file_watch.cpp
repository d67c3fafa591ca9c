// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <thread>

#include "runtime/realtime/file_watch.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace realtime;

class Watched : public ::testing::Test {
  protected:
    void SetUp() override { std::ofstream(file_) << "an asset"; }
    // Waits for the next report; true if it is `expected` and the number of reports is `count`.
    bool reports(bool expected, int count) const {
        for (int i = 0; i < 400 && count_ < count; ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        return count_ == count && gone_ == expected;
    }

    sample::Scratch folder_;
    std::filesystem::path file_ = folder_ / "watched";
    std::filesystem::path aside_ = folder_ / "aside";
    std::atomic<int> count_{0};
    std::atomic<bool> gone_{false};
    FileWatch::OnChange note_ = [this](bool gone) {
        gone_ = gone;
        ++count_;
    };
};

TEST_F(Watched, a_file_that_is_moved_away_and_back_is_told_of_once_each) {
    const FileWatch watch(file_, note_);
    std::filesystem::rename(file_, aside_);
    EXPECT_TRUE(reports(true, 1));
    std::filesystem::rename(aside_, file_);
    EXPECT_TRUE(reports(false, 2));
}

TEST_F(Watched, another_file_of_the_same_name_is_not_the_same) {
    const FileWatch watch(file_, note_);
    std::ofstream(aside_) << "an asset";
    std::filesystem::rename(aside_, file_);
    EXPECT_TRUE(reports(true, 1));
}

TEST_F(Watched, a_file_that_was_shortened_is_not_the_same) {
    const FileWatch watch(file_, note_);
    std::filesystem::resize_file(file_, 2);
    EXPECT_TRUE(reports(true, 1));
}

}  // namespace
}  // namespace palpate
