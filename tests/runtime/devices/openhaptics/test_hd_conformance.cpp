// SPDX-License-Identifier: Apache-2.0
// What the conformance library does, seen as an application sees it; test_hd_faults.cpp has its troubles.
#include <array>
#include <atomic>
#include <cstdio>
#include <cstdlib>
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <string>
#include <utility>
#include <vector>

#include "tests/formats/scratch.hpp"
#include "tests/runtime/devices/openhaptics/hd_conformance.hpp"

namespace palpate::hd {
namespace {

TEST_F(HdConformance, exports_the_interface_and_nothing_else) {
    FILE* pipe = popen(("nm -D --defined-only " + conformance_library_path()).c_str(), "r");
    ASSERT_NE(pipe, nullptr);
    std::array<char, 512> line{};
    int found = 0;
    while (std::fgets(line.data(), static_cast<int>(line.size()), pipe)) {
        const std::string text(line.data());
        const std::string name = text.substr(text.rfind(' ') + 1);
        EXPECT_TRUE(name.starts_with("hd") || name.starts_with("palpate_hd_")) << name;
        ++found;
    }
    pclose(pipe);
    EXPECT_EQ(found, 35);
}

TEST_F(HdConformance, opens_by_name_or_by_default_and_never_twice) {
    configure(R"({"clock":"virtual","devices":[{"name":"left"},{"name":"right"}]})");
    EXPECT_EQ(hd.hdInitDevice(""), invalid_handle);
    EXPECT_EQ(error(), comm_config_error);
    EXPECT_EQ(hd.hdInitDevice("middle"), invalid_handle);
    EXPECT_EQ(error(), comm_config_error);
    const Handle left = hd.hdInitDevice(nullptr);
    EXPECT_STREQ(hd.hdGetString(device_serial), "left");
    EXPECT_EQ(hd.hdInitDevice("left"), invalid_handle);
    EXPECT_EQ(error(), already_initiated);
    const Handle right = hd.hdInitDevice("right");
    EXPECT_NE(left, right);
    EXPECT_EQ(hd.hdGetCurrentDevice(), right);
    hd.hdMakeCurrentDevice(left);
    EXPECT_EQ(hd.hdGetCurrentDevice(), left);
    hd.hdDisableDevice(left);
    EXPECT_EQ(hd.hdGetCurrentDevice(), invalid_handle);
    EXPECT_EQ(error(), success);
    hd.hdMakeCurrentDevice(left);
    EXPECT_EQ(error(), bad_handle);
    EXPECT_NE(hd.hdInitDevice("left"), invalid_handle);
    EXPECT_EQ(error(), success);
}

TEST_F(HdConformance, refuses_to_open_as_the_script_says) {
    const std::array<std::pair<const char*, unsigned>, 4> refusals{
        {{"comm", comm_error},
         {"comm_config", comm_config_error},
         {"licence", invalid_licence},
         {"already_initiated", already_initiated}}};
    for (const auto& [name, code] : refusals) {
        EXPECT_EQ(open(R"("refuse":")" + std::string(name) + '"'), invalid_handle);
        const ErrorInfo info = hd.hdGetError();
        EXPECT_EQ(info.code, code);
        EXPECT_EQ(info.device, invalid_handle);
    }
}

TEST_F(HdConformance, a_library_loaded_again_opens_nothing_and_a_file_may_be_its_script) {
    // Tests before this one in the same process hold it too: each look takes one hold more, then two go.
    while (void* object = dlopen(conformance_library_path().c_str(), RTLD_NOW | RTLD_NOLOAD)) {
        dlclose(object);
        dlclose(object);
    }
    const sample::Scratch scratch;
    std::ofstream(scratch / "script.json") << R"({"devices":[{"name":"of the file"}]})";
    setenv("PALPATE_HD_SCRIPT", (scratch / "script.json").c_str(), 1);
    Functions again(conformance_library_path());
    EXPECT_EQ(again.hdInitDevice(nullptr), invalid_handle);
    EXPECT_EQ(again.hdGetError().code, device_fault);
    unsetenv("PALPATE_HD_UNLOADED_IN");
    EXPECT_NE(again.hdInitDevice(nullptr), invalid_handle);
    EXPECT_STREQ(again.hdGetString(device_serial), "of the file");  // the first opening read the script
    unsetenv("PALPATE_HD_SCRIPT");
    hd.configure = again.configure;
}

TEST_F(HdConformance, errors_come_latest_first_with_their_device) {
    const Handle device = open();
    hd.hdEndFrame(device);
    hd.hdMakeCurrentDevice(77);
    hd.hdEnable(0x1234);
    EXPECT_EQ(error(), invalid_enum);
    const ErrorInfo bad = hd.hdGetError();
    EXPECT_EQ(bad.code, bad_handle);
    EXPECT_EQ(bad.device, 77U);
    const ErrorInfo end = hd.hdGetError();
    EXPECT_EQ(end.code, illegal_end);
    EXPECT_EQ(end.device, device);
    EXPECT_NE(end.internal, 0);
    EXPECT_EQ(error(), success);
    EXPECT_STRNE(hd.hdGetErrorString(bad_handle), hd.hdGetErrorString(0x999));
}

TEST_F(HdConformance, a_frame_holds_the_state_and_takes_the_force) {
    const Handle device = open(R"("hand":"rigid","path":[[0,0,0,0],[1,1000,0,0]])");
    Vector p{}, force{1, 0, 0};
    hd.hdGetDoublev(current_position, p.data());
    EXPECT_EQ(error(), invalid_operation);
    hd.hdSetDoublev(current_force, force.data());
    EXPECT_EQ(error(), invalid_operation);
    hd.hdStartScheduler();
    in_servo([&] {
        hd.hdBeginFrame(device);
        hd.hdGetDoublev(current_position, p.data());
        hd.hdEndFrame(device);
    });
    EXPECT_NEAR(p[0], 1, 1e-12);  // the first tick is at 1 ms
    in_servo([&] {
        hd.hdBeginFrame(device);
        hd.hdGetDoublev(current_position, p.data());
        Vector last{};
        hd.hdGetDoublev(last_position, last.data());
        EXPECT_NEAR(last[0], 1, 1e-12);
        hd.hdEndFrame(device);
    });
    EXPECT_NEAR(p[0], 2, 1e-12);
    EXPECT_EQ(error(), success);
}

TEST_F(HdConformance, frames_nest_but_do_not_come_twice_in_a_tick) {
    const Handle device = open();
    hd.hdStartScheduler();
    in_servo([&] {
        hd.hdBeginFrame(device);
        hd.hdBeginFrame(device);
        hd.hdEndFrame(device);
        hd.hdEndFrame(device);
        EXPECT_EQ(error(), success);
        hd.hdBeginFrame(device);
        EXPECT_EQ(error(), illegal_begin);
        hd.hdEndFrame(device);
        EXPECT_EQ(error(), illegal_end);
        hd.hdDisable(one_frame_limit);
        frame(device, {0, 0, 0});
        EXPECT_EQ(error(), success);
    });
    in_servo([&] {
        const Vector force{1, 0, 0};
        hd.hdBeginFrame(device);
        hd.hdSetDoublev(current_force, force.data());
    });
    in_servo([&] {
        EXPECT_EQ(error(), frame_error);
        Vector force{9, 9, 9};
        hd.hdBeginFrame(device);
        hd.hdGetDoublev(current_force, force.data());
        hd.hdEndFrame(device);
        EXPECT_EQ(force, (Vector{0, 0, 0}));
    });
}

TEST_F(HdConformance, each_type_of_parameter_has_its_own_function) {
    const Handle device = open(R"("inkwell":true)");
    std::array<double, 16> real{};
    std::array<int, 16> whole{};
    std::array<long, 16> longs{};
    std::array<float, 16> floats{};
    unsigned char flag = 0;
    hd.hdBeginFrame(device);
    hd.hdGetIntegerv(inkwell_switch, whole.data());
    EXPECT_EQ(error(), invalid_input_type);
    hd.hdGetBooleanv(inkwell_switch, &flag);
    EXPECT_EQ(flag, 1);
    hd.hdGetDoublev(buttons, real.data());
    EXPECT_EQ(error(), invalid_input_type);
    hd.hdGetIntegerv(buttons, whole.data());
    hd.hdGetIntegerv(current_position, whole.data());
    EXPECT_EQ(error(), invalid_input_type);
    hd.hdGetFloatv(nominal_max_force, floats.data());
    EXPECT_EQ(floats[0], 3.3F);
    hd.hdGetDoublev(nominal_max_continuous_force, real.data());
    EXPECT_EQ(real[0], 0.88);
    hd.hdGetLongv(encoder_values, longs.data());
    hd.hdGetIntegerv(update_rate, whole.data());
    EXPECT_EQ(whole[0], 1000);
    hd.hdGetDoublev(usable_workspace, real.data());
    EXPECT_EQ(real[0], -80);
    EXPECT_EQ(real[3], 80);
    EXPECT_EQ(error(), success);
    hd.hdGetDoublev(0x2999, real.data());
    EXPECT_EQ(error(), invalid_enum);
    hd.hdSetDoublev(nominal_max_force, real.data());
    EXPECT_EQ(error(), invalid_enum);
    hd.hdSetIntegerv(current_force, whole.data());
    EXPECT_EQ(error(), invalid_input_type);
    hd.hdEndFrame(device);
}

TEST_F(HdConformance, the_transform_is_column_major_and_turns_z_into_the_shaft) {
    const Handle device = open(R"("shaft":[3,0,4],"path":[[0,1,2,3]])");
    std::array<double, 16> transform{};
    hd.hdBeginFrame(device);
    hd.hdGetDoublev(current_transform, transform.data());
    hd.hdEndFrame(device);
    const std::array<double, 8> third_and_last{0.6,           0, 0.8, 0, transform[12], transform[13],
                                               transform[14], 1};
    for (std::size_t i = 0; i < 8; ++i) EXPECT_NEAR(transform[8 + i], third_and_last[i], 1e-15);
    // As its encoders read it: rounded down to 0.055 mm.
    EXPECT_NEAR(transform[12], 0.99, 1e-12);
    EXPECT_NEAR(transform[14], 2.97, 1e-12);
}

TEST_F(HdConformance, forces_act_only_while_output_is_on_and_ramp_up) {
    const Handle device = open();
    hd.hdStartScheduler();
    push(device, {2, 0, 0}, 20);
    EXPECT_EQ(rendered(device), (Vector{0, 0, 0}));
    hd.hdEnable(force_output);
    EXPECT_EQ(hd.hdIsEnabled(force_output), 1);
    push(device, {2, 0, 0}, 50);
    EXPECT_NEAR(rendered(device)[0], 0.5, 1e-12);  // 10 N/s
    push(device, {2, 0, 0}, 150);
    EXPECT_NEAR(rendered(device)[0], 2, 1e-12);
    EXPECT_GT(hd.hardware(device).position[0], 0.1);
    hd.hdDisable(force_output);
    EXPECT_EQ(rendered(device), (Vector{0, 0, 0}));
    hd.hdDisable(force_ramping);
    hd.hdEnable(force_output);
    push(device, {2, 0, 0}, 1);
    EXPECT_NEAR(rendered(device)[0], 2, 1e-12);
    hd.hdStopScheduler();
    EXPECT_EQ(rendered(device), (Vector{0, 0, 0}));
    EXPECT_EQ(hd.hardware(device).asked[0], 2);
    EXPECT_EQ(error(), success);
}

TEST_F(HdConformance, too_large_a_force_is_clamped_or_refused) {
    const Handle device = open();
    hd.hdEnable(force_output);
    hd.hdDisable(force_ramping);
    hd.hdStartScheduler();
    push(device, {3, 0, 4}, 1);
    EXPECT_NEAR(rendered(device)[0], 3.3 * 0.6, 1e-12);
    EXPECT_NEAR(rendered(device)[2], 3.3 * 0.8, 1e-12);
    EXPECT_EQ(error(), success);
    hd.hdDisable(max_force_clamping);
    push(device, {3, 0, 4}, 1);
    EXPECT_EQ(error(), exceeded_max_force);
    EXPECT_EQ(rendered(device), (Vector{0, 0, 0}));
    push(device, {3, 0, 0}, 1);
    EXPECT_EQ(error(), success);
    EXPECT_NEAR(rendered(device)[0], 3, 1e-12);
    const double impulse = 1;
    hd.hdSetDoublev(impulse_limit, &impulse);
    push(device, {1.9, 0, 0}, 1);
    EXPECT_EQ(error(), exceeded_impulse);
    push(device, {std::numeric_limits<double>::quiet_NaN(), 0, 0}, 1);
    EXPECT_EQ(error(), force_error);
    const double nonsense = -1;
    hd.hdSetDoublev(impulse_limit, &nonsense);
    EXPECT_EQ(error(), invalid_value);
}

TEST_F(HdConformance, too_fast_a_tip_gets_no_force) {
    const Handle device = open(R"("hand":"rigid","path":[[0,0,0,0],[1,2000,0,0]])");
    hd.hdEnable(force_output);
    hd.hdStartScheduler();
    push(device, {1, 0, 0}, 100);
    unsigned last = success;
    for (unsigned code = error(); code != success; code = error()) last = code;
    EXPECT_EQ(last, exceeded_velocity);
    EXPECT_EQ(rendered(device), (Vector{0, 0, 0}));
}

TEST_F(HdConformance, callbacks_run_by_priority_until_they_are_done) {
    open();
    struct Log {
        std::vector<int> order;
        int calls = 0;
    } log;
    const auto low = [](void* data) -> unsigned {
        auto& l = *static_cast<Log*>(data);
        l.order.push_back(1);
        return ++l.calls < 3 ? callback_continue : callback_done;
    };
    const auto high = [](void* data) -> unsigned {
        static_cast<Log*>(data)->order.push_back(2);
        return callback_done;
    };
    const unsigned long first = hd.hdScheduleAsynchronous(low, &log, 0);
    const unsigned long second = hd.hdScheduleAsynchronous(high, &log, 65535);
    EXPECT_GT(first, 0xFFFFFFFFUL);
    EXPECT_EQ(hd.hdWaitForCompletion(first, 0), 1);
    hd.hdStartScheduler();
    EXPECT_EQ(hd.hdWaitForCompletion(first, 1), 1);
    EXPECT_EQ(hd.hdWaitForCompletion(first, 0), 0);
    EXPECT_EQ(hd.hdWaitForCompletion(second, 0), 0);
    EXPECT_EQ(log.order, (std::vector<int>{2, 1, 1, 1}));
    hd.hdUnschedule(second);
    EXPECT_EQ(error(), invalid_operation);
    EXPECT_EQ(hd.hdScheduleAsynchronous(nullptr, nullptr, 0), 0UL);
    EXPECT_EQ(error(), invalid_value);
}

TEST_F(HdConformance, an_unscheduled_callback_does_not_run_again) {
    open("", "real");
    std::atomic<int> calls{0};
    const unsigned long handle = hd.hdScheduleAsynchronous(
        [](void* data) -> unsigned {
            ++*static_cast<std::atomic<int>*>(data);
            return callback_continue;
        },
        &calls, 1);
    hd.hdStartScheduler();
    while (calls < 5) in_servo([] {});
    hd.hdUnschedule(handle);
    const int then = calls;
    for (int tick = 0; tick < 5; ++tick) in_servo([] {});
    EXPECT_EQ(calls, then);
    EXPECT_EQ(error(), success);
    double stamp = -1;
    in_servo([&] { stamp = hd.hdGetSchedulerTimeStamp(); });
    EXPECT_GE(stamp, 0);
}

TEST_F(HdConformance, takes_so_many_callbacks_and_no_more) {
    open();
    const auto idle = [](void*) -> unsigned { return callback_done; };
    for (int i = 0; i < 32; ++i) EXPECT_NE(hd.hdScheduleAsynchronous(idle, nullptr, 1), 0UL);
    EXPECT_EQ(hd.hdScheduleAsynchronous(idle, nullptr, 1), 0UL);
    EXPECT_EQ(error(), scheduler_full);
}

TEST_F(HdConformance, the_rate_may_be_refused_and_is_then_what_it_was) {
    open();
    int rate = 0;
    hd.hdSetSchedulerRate(1234);
    EXPECT_EQ(error(), invalid_value);
    hd.hdSetSchedulerRate(500);
    hd.hdGetIntegerv(update_rate, &rate);
    EXPECT_EQ(rate, 500);
    EXPECT_EQ(error(), success);
    hd.hdStartScheduler();
    hd.hdSetSchedulerRate(1000);
    EXPECT_EQ(error(), invalid_operation);
    configure(R"({"rate_hz":500,"rate_refusal":"timer"})");
    hd.hdInitDevice(nullptr);
    hd.hdSetSchedulerRate(1000);
    EXPECT_EQ(error(), timer_error);
    hd.hdGetIntegerv(update_rate, &rate);
    EXPECT_EQ(rate, 500);
}

TEST_F(HdConformance, calibrates_by_the_styles_a_device_has) {
    open(R"("calibration":"needs_update","styles":["auto","reset"])");
    EXPECT_EQ(hd.hdCheckCalibration(), calibration_needs_update);
    EXPECT_EQ(hd.hdCheckCalibrationStyle(), style_auto | style_reset);
    hd.hdUpdateCalibration(style_inkwell);
    EXPECT_EQ(error(), invalid_value);
    hd.hdUpdateCalibration(style_auto);
    EXPECT_EQ(hd.hdCheckCalibration(), calibration_ok);
    open(R"("calibration":"needs_manual_input","styles":["inkwell"])");
    hd.hdUpdateCalibration(style_inkwell);
    EXPECT_EQ(error(), device_fault);
    EXPECT_EQ(hd.hdCheckCalibration(), calibration_needs_manual_input);
    open(R"("calibration":"needs_manual_input","styles":["inkwell"],"inkwell":true)");
    hd.hdUpdateCalibration(style_inkwell);
    EXPECT_EQ(hd.hdCheckCalibration(), calibration_ok);
    EXPECT_EQ(error(), success);
}

TEST_F(HdConformance, buttons_go_down_and_up_at_their_times) {
    const Handle device = open(R"("buttons":[{"button":1,"from":0.002,"until":0.004}])");
    hd.hdStartScheduler();
    std::vector<int> seen;
    for (int tick = 0; tick < 5; ++tick)
        in_servo([&] {
            int now = 0;
            hd.hdBeginFrame(device);
            hd.hdGetIntegerv(buttons, &now);
            hd.hdEndFrame(device);
            seen.push_back(now);
        });
    EXPECT_EQ(seen, (std::vector<int>{0, 2, 2, 0, 0}));
}

TEST_F(HdConformance, two_devices_have_their_own_state_and_force) {
    configure(R"({"clock":"virtual","devices":[{"name":"left","hand":"rigid","path":[[0,1,0,0]]},
                  {"name":"right","model":"premium","hand":"rigid","path":[[0,2,0,0]]}]})");
    const Handle left = hd.hdInitDevice("left"), right = hd.hdInitDevice("right");
    hd.hdDisable(force_ramping);
    hd.hdEnable(force_output);
    hd.hdStartScheduler();
    in_servo([&] {
        frame(left, {0, 3, 0});
        frame(right, {0, 0, 5});
    });
    EXPECT_EQ(rendered(left), (Vector{0, 0, 0}));  // whose output nobody has enabled
    EXPECT_EQ(rendered(right), (Vector{0, 0, 5}));
    EXPECT_EQ(hd.hardware(left).asked[1], 3);
    EXPECT_EQ(hd.hardware(right).position[0], 2);
}

}  // namespace
}  // namespace palpate::hd
