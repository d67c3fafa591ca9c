// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sstream>
#include <string>
#include <vector>

#include "runtime/session/run_record.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using session::RunRecord;

// A sphere of 1 mm goes into the top of a soft cube of 20 mm and out again, 0.1 mm a tick; one tick gets lost
// on the way.
class RunRecordTest : public ::testing::Test {
  protected:
    static constexpr int down = 30, lost = 20;

    RunRecordTest() {
        case_.name = "cube";
        case_.deformable_bodies.push_back(sample::true_elastic_cube(3));
        case_.deformable_bodies.front().name = "soft, \"left\"";
        case_.haptics = {.tool_radius = 1, .coupling_stiffness = 0.5, .max_force = 50, .max_force_rate = 50};
        haptics::HapticModel model(case_);
        RunRecord record(model, &log_);
        for (int tick = 0; tick <= 2 * down; ++tick) {
            TickResult result{};
            model.tick(held_at({10, 10, 22 - 0.1 * std::min(tick, 2 * down - tick)}), result);
            result.tick = tick;
            result.time = 1e-3 * tick;
            if (tick == lost) continue;
            record.add(result);
            forces_.push_back(force_of(result));
        }
        curve_ = record.curve();
        peak_ = record.peak();
        peak_force_ = record.peak_force();
        step_ = record.largest_force_step();
        device_depth_ = record.device_depth();
        tool_depth_ = record.tool_depth();
    }

    Case case_;
    std::ostringstream log_;
    std::vector<Vector3d> forces_;
    std::vector<session::CurvePoint> curve_;
    TickResult peak_{};
    double peak_force_ = 0, step_ = 0, device_depth_ = 0, tool_depth_ = 0;
};

TEST_F(RunRecordTest, keeps_the_tick_of_the_largest_force_and_how_deep_it_was) {
    EXPECT_EQ(peak_.tick, down);
    EXPECT_GT(peak_force_, 0);
    EXPECT_EQ(peak_force_, forces_[down - 1].norm());  // one tick before it is missing
    EXPECT_NEAR(device_depth_, 0.1 * down - 1, 1e-3);
    EXPECT_GE(tool_depth_, 0);
    EXPECT_LT(tool_depth_, 1e-2);  // of what the solver leaves
    ASSERT_EQ(curve_.size(), forces_.size());
    EXPECT_EQ(curve_[down - 1].force, peak_force_);
}

TEST_F(RunRecordTest, counts_no_step_of_the_force_over_a_tick_that_is_lost) {
    double largest = 0;
    for (std::size_t n = 1; n < forces_.size(); ++n)
        if (n != lost) largest = std::max(largest, (forces_[n] - forces_[n - 1]).norm());
    EXPECT_GT(largest, 0);
    EXPECT_EQ(step_, largest);
}

TEST_F(RunRecordTest, writes_a_row_of_csv_for_each_tick_with_names_in_quotes_that_need_them) {
    std::ostringstream head;
    session::write_log_head(head);
    const auto columns = std::ranges::count(head.str(), ',') + 1;
    std::istringstream rows(log_.str());
    std::size_t count = 0, named = 0;
    for (std::string row; std::getline(rows, row); ++count) {
        const std::string name = "\"soft, \"\"left\"\"\"";
        const bool has_name = row.find(name) != std::string::npos;
        named += has_name ? 1U : 0U;
        EXPECT_EQ(std::ranges::count(row, ',') + 1, columns + (has_name ? 1 : 0)) << row;
    }
    EXPECT_EQ(count, forces_.size());
    EXPECT_GT(named, 10U);
    EXPECT_LT(named, count);
    EXPECT_THAT(log_.str(), ::testing::StartsWith("0.000,10.0000,10.0000,22.0000,"));
}

}  // namespace
}  // namespace palpate
