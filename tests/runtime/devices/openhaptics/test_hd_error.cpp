// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <deque>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <string>

#include "runtime/devices/openhaptics/hd_error.hpp"

namespace palpate {
namespace {

using namespace devices;
using namespace hdapi;
using ::testing::HasSubstr;

constexpr HdHandle left = 0, right = 1;  // HDAPI's handles count from 0

// The error stack of a driver that has nothing else.
std::deque<HdErrorInfo> stack;
bool endless = false;

const HdApi& driver_with(std::deque<HdErrorInfo> errors) {
    static const HdApi api = [] {
        HdApi only_errors{};
        only_errors.get_error = [] {
            if (stack.empty()) return HdErrorInfo{success, 0, invalid_handle};
            const HdErrorInfo error = stack.front();
            if (!endless) stack.pop_front();
            return error;
        };
        return only_errors;
    }();
    stack = std::move(errors);
    endless = false;
    return api;
}

std::uint32_t fault_of(unsigned code) {
    return find_hd_error(code)->fault;
}

TEST(HdError, each_code_names_its_cause_and_a_fix) {
    EXPECT_EQ(hd_error_texts().size(), 21u);
    EXPECT_TRUE(std::ranges::is_sorted(hd_error_texts(), {}, &HdErrorText::code));
    for (const HdErrorText& text : hd_error_texts()) {
        EXPECT_TRUE(std::string(text.name).starts_with("HD_")) << text.code;
        EXPECT_GT(std::string(text.cause).size(), 10u) << text.name;
        EXPECT_GT(std::string(text.fix).size(), 10u) << text.name;
        EXPECT_EQ(find_hd_error(text.code), &text);
    }
}

TEST(HdError, a_killed_process_a_licence_and_a_permission_have_their_fix) {
    EXPECT_THAT(find_hd_error(0x303)->fix, HasSubstr("plug it in again"));
    EXPECT_THAT(find_hd_error(0x600)->fix, HasSubstr("licence"));
    EXPECT_THAT(find_hd_error(0x302)->fix, HasSubstr("udev"));
    EXPECT_THAT(find_hd_error(0x301)->fix, HasSubstr("once"));
}

TEST(HdError, faults_take_the_force_away_where_the_device_cannot_render_it) {
    EXPECT_EQ(fault_of(warm_motors), motors_warm);
    for (const unsigned code :
         {exceeded_max_force, exceeded_max_force_impulse, exceeded_max_velocity, force_error})
        EXPECT_EQ(fault_of(code), device_refused) << code;
    for (const unsigned code :
         {bad_handle, device_fault, comm_error, comm_config_error, illegal_begin, illegal_end, frame_error})
        EXPECT_EQ(fault_of(code), device_lost) << code;
    EXPECT_EQ(fault_of(timer_error), tick_late);
    for (const unsigned code : {invalid_enum, invalid_value, invalid_operation, invalid_input_type,
                                invalid_priority, scheduler_full})
        EXPECT_EQ(fault_of(code), no_fault) << code;
}

TEST(HdError, an_explanation_has_the_culprit_the_names_and_the_drivers_own_code) {
    const ErrorDetail detail = explain_hd_error("device 'Left'", {comm_error, -7, left});
    EXPECT_EQ(detail.culprit, "device 'Left'");
    EXPECT_THAT(detail.found, HasSubstr("HD_COMM_ERROR, 0x302, the driver's own code -7"));
    EXPECT_EQ(detail.next_step, find_hd_error(comm_error)->fix);
}

TEST(HdError, a_code_that_hdapi_does_not_define_is_said_to_be_so) {
    EXPECT_EQ(find_hd_error(0x777), nullptr);
    EXPECT_THAT(explain_hd_error("device", {0x777, 0, left}).found, HasSubstr("0x777"));
}

TEST(HdError, the_first_of_several_errors_is_returned_and_the_stack_is_empty_then) {
    const HdApi& api = driver_with({{comm_error, 0, left}, {frame_error, 0, left}});
    EXPECT_EQ(take_hd_errors(api).code, comm_error);
    EXPECT_TRUE(stack.empty());
    EXPECT_EQ(take_hd_errors(api).code, success);
}

TEST(HdError, a_stack_that_never_ends_is_given_up) {
    const HdApi& api = driver_with({{comm_error, 0, left}});
    endless = true;
    EXPECT_EQ(take_hd_errors(api).code, comm_error);
    HdErrorSorter sorter(api);
    sorter.add(left);
    sorter.drain();
    EXPECT_EQ(sorter.take(left), device_lost);
}

TEST(HdErrorSorter, an_error_goes_to_the_device_that_it_is_about_once) {
    HdErrorSorter sorter(
        driver_with({{comm_error, 0, right}, {warm_motors, 0, left}, {force_error, 0, right}}));
    sorter.add(left);
    sorter.add(right);
    sorter.drain();
    EXPECT_EQ(sorter.take(left), motors_warm);
    EXPECT_EQ(sorter.take(right), device_lost | device_refused);
    EXPECT_EQ(sorter.take(right), no_fault);
}

TEST(HdErrorSorter, an_error_about_no_known_device_concerns_all) {
    HdErrorSorter sorter(driver_with({{timer_error, 0, invalid_handle}}));
    sorter.add(left);
    sorter.add(right);
    sorter.drain();
    EXPECT_EQ(sorter.take(left), tick_late);
    EXPECT_EQ(sorter.take(right), tick_late);
}

TEST(HdErrorSorter, refuses_more_devices_than_it_has_room_for) {
    HdErrorSorter sorter(driver_with({}));
    for (HdHandle device = 0; device < HdErrorSorter::most_devices; ++device) sorter.add(device);
    EXPECT_THROW(sorter.add(99), InvalidInput);
}

}  // namespace
}  // namespace palpate
