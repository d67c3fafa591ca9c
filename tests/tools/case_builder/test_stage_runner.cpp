// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>
#include <thread>

#include "formats/model/errors.hpp"
#include "tools/case_builder/folder_lock.hpp"
#include "tools/case_builder/stage_runner.hpp"

namespace palpate::case_builder {
namespace {

using namespace case_builder;

// A folder with a made-up command palpate-copy that counts its runs and copies as its request says.
class StageRunnerTest : public testing::Test {
  protected:
    void SetUp() override {
        folder_ = std::filesystem::path(testing::TempDir()) /
                  testing::UnitTest::GetInstance()->current_test_info()->name();
        std::filesystem::remove_all(folder_);
        std::filesystem::create_directories(folder_);
        write("palpate-copy",
              "#!/bin/sh\necho run >> \"$(dirname \"$0\")/runs\"\n"
              "value() { sed -n 's/.*\"'$1'\": \"\\(.*\\)\".*/\\1/p' \"$request\"; }\n"
              "while [ $# -gt 0 ]; do\n"
              "[ \"$1\" = --request ] && request=$2\n"
              "[ \"$1\" = --json ] && echo '{\"answer\": 42}' > \"$2\"\nshift; done\n"
              "cp \"$(value input)\" \"$(value output)\"\n");
        write("palpate-refuse",
              "#!/bin/sh\nwhile [ $# -gt 0 ]; do\n"
              "[ \"$1\" = --error-file ] && echo 'refuse: no such liver' > \"$2\"\nshift; done\nexit 3\n");
        write("palpate-die", "#!/bin/sh\nkill -9 $$\n");
        for (const char* program : {"palpate-copy", "palpate-refuse", "palpate-die"})
            std::filesystem::permissions(folder_ / program, std::filesystem::perms::owner_all);
        write("input", "one");
    }

    void write(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name) << text;
    }

    int runs() const {
        std::ifstream stream(folder_ / "runs");
        int count = 0;
        for (std::string line; std::getline(stream, line);) ++count;
        return count;
    }

    StageRecord run(int depth = 0) const {
        const auto input = folder_ / "input", output = folder_ / "output";
        const Stage stage{"copy it",
                          "copy",
                          {{"input", input.string()}, {"output", output.string()}, {"depth", depth}},
                          {input},
                          {output}};
        return StageRunner(folder_, folder_ / "parts", 1, true).run(stage);
    }

    std::filesystem::path folder_;
};

TEST_F(StageRunnerTest, what_may_have_no_end_is_not_digested) {
    EXPECT_THROW(content_digest("/dev/zero"), InvalidInput);
}

TEST_F(StageRunnerTest, runs_once_and_remembers_the_result) {
    EXPECT_TRUE(run().ran);
    const StageRecord again = run();
    EXPECT_FALSE(again.ran);
    EXPECT_EQ(again.result["answer"], 42);
    EXPECT_EQ(runs(), 1);
}

TEST_F(StageRunnerTest, runs_again_when_content_request_output_or_program_changes) {
    run();
    write("input", "two");
    EXPECT_TRUE(run().ran);
    EXPECT_TRUE(run(3).ran);
    write("output", "altered");
    EXPECT_TRUE(run(3).ran);
    std::ofstream(folder_ / "palpate-copy", std::ios::app) << "# newer\n";
    EXPECT_TRUE(run(3).ran);
    EXPECT_FALSE(run(3).ran);
}

TEST_F(StageRunnerTest, a_folder_that_moved_is_up_to_date) {
    run();
    const auto before = folder_;
    folder_ += "_moved";
    std::filesystem::remove_all(folder_);
    std::filesystem::rename(before, folder_);
    EXPECT_FALSE(run().ran);
}

TEST_F(StageRunnerTest, touching_a_file_without_changing_it_runs_nothing) {
    run();
    write("input", "one");
    EXPECT_FALSE(run().ran);
}

TEST_F(StageRunnerTest, a_childs_exit_code_becomes_the_error_of_its_kind) {
    const StageRunner runner(folder_, folder_ / "parts", 1, true);
    EXPECT_THROW(runner.run({"refuse", "refuse", {}, {folder_ / "input"}, {}}), InvalidInput);
}

TEST_F(StageRunnerTest, remembers_what_bad_input_met_until_the_input_changes) {
    const StageRunner runner(folder_, folder_ / "parts", 1, true);
    const Stage stage{"refuse", "refuse", {}, {folder_ / "input"}, {}};
    EXPECT_FALSE(runner.failed(stage));
    EXPECT_THROW(runner.run(stage), InvalidInput);
    const auto failure = runner.failed(stage);
    ASSERT_TRUE(failure);
    EXPECT_EQ(failure->exit_code, 3);
    EXPECT_EQ(failure->said, "refuse: no such liver\n");
    EXPECT_TRUE(is_lasting(*failure));
    write("input", "mended");
    EXPECT_FALSE(runner.failed(stage));
}

TEST_F(StageRunnerTest, a_stage_that_the_machine_killed_may_be_tried_again_and_says_what_ended_it) {
    const StageRunner runner(folder_, folder_ / "parts", 1, true);
    const Stage stage{"die", "die", {}, {folder_ / "input"}, {}};
    EXPECT_THROW(runner.run(stage), SystemFailure);
    const auto failure = runner.failed(stage);
    ASSERT_TRUE(failure);
    EXPECT_FALSE(is_lasting(*failure));
    EXPECT_EQ(failure->exit_code, 128 + 9);
    EXPECT_NE(failure->said.find("was ended by signal 9"), std::string::npos) << failure->said;
    EXPECT_TRUE(std::filesystem::exists(runner.error_path("die")));
}

TEST_F(StageRunnerTest, a_finished_stage_is_known_without_running_it) {
    const auto input = folder_ / "input", output = folder_ / "output";
    const Stage stage{"copy it",
                      "copy",
                      {{"input", input.string()}, {"output", output.string()}, {"depth", 0}},
                      {input},
                      {output}};
    const StageRunner runner(folder_, folder_ / "parts", 1, true);
    EXPECT_FALSE(runner.finished(stage));
    run();
    const auto record = runner.finished(stage);
    ASSERT_TRUE(record);
    EXPECT_EQ(record->result["answer"], 42);
    write("input", "two");
    EXPECT_FALSE(runner.finished(stage));
    EXPECT_TRUE(runner.recorded("copy it"));
    EXPECT_EQ(runs(), 1);
}

TEST_F(StageRunnerTest, two_runs_of_one_stage_at_once_do_the_work_once) {
    std::thread other([this] { run(); });
    run();
    other.join();
    EXPECT_EQ(runs(), 1);
}

TEST_F(StageRunnerTest, a_lock_is_seen_while_it_is_held_and_no_longer) {
    {
        const FolderLock lock(folder_, "batch");
        EXPECT_TRUE(FolderLock::held_by_another(folder_, "batch"));
        EXPECT_FALSE(FolderLock::held_by_another(folder_, "mesh liver"));
    }
    EXPECT_FALSE(FolderLock::held_by_another(folder_, "batch"));
}

TEST_F(StageRunnerTest, knows_its_own_outputs) {
    run();
    const StageRunner runner(folder_, folder_ / "parts", 1, true);
    EXPECT_TRUE(runner.made_by_us("copy it", folder_ / "output"));
    write("output", "somebody else's");
    EXPECT_FALSE(runner.made_by_us("copy it", folder_ / "output"));
}

}  // namespace
}  // namespace palpate::case_builder
