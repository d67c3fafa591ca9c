// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/openhaptics/hd_servo.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <iterator>
#include <limits>
#include <string>
#include <thread>
#include <utility>

#include "formats/model/errors.hpp"
#include "runtime/devices/openhaptics/hd_error.hpp"
#include "runtime/realtime/periodic_clock.hpp"

namespace palpate::devices {
namespace {

using namespace realtime;
using namespace hdapi;
using std::chrono::milliseconds;

constexpr unsigned long rate_hz = 1'000'000'000 / Servo::period_ns;
constexpr milliseconds start_patience{3000};   // for a scheduler's first tick
constexpr milliseconds release_patience{250};  // for its last

bool wait_for(const std::atomic<bool>& flag, milliseconds patience) {
    const auto give_up = std::chrono::steady_clock::now() + patience;
    while (!flag.load() && std::chrono::steady_clock::now() < give_up)
        std::this_thread::sleep_for(milliseconds(1));
    return flag.load();
}

// Some drivers refuse to be told a rate and run at the right one nonetheless.
bool may_be_ignored(unsigned code) {
    return code == success || code == invalid_value || code == timer_error || code == invalid_operation;
}

}  // namespace

HdServo::HdServo(const HdApi& api, std::vector<HdDevice*> devices, std::vector<SetupResult> notes)
    : api_(api), devices_(std::move(devices)), notes_(std::move(notes)) {}

void HdServo::start_scheduler() {
    if (scheduler_runs_) return;
    take_hd_errors(api_);
    api_.set_scheduler_rate(rate_hz);
    if (const HdErrorInfo error = take_hd_errors(api_); !may_be_ignored(error.code))
        throw SystemFailure(explain_hd_error("the device's scheduler", error));
    api_.start_scheduler();
    scheduler_runs_ = true;
    if (const HdErrorInfo error = take_hd_errors(api_); error.code != success) {
        stop();
        throw SystemFailure(explain_hd_error("the device's scheduler", error));
    }
    for (HdDevice* device : devices_) device->ask_rate();
    const double told = devices_.empty() ? 0 : devices_.front()->limits().rate_hz;
    if (told == 0 || std::lround(told) == static_cast<long>(rate_hz)) return;
    stop();
    throw SystemFailure({"the device's scheduler", std::to_string(std::lround(told)) + " ticks a second",
                         "1000", "set the rate to 1000 Hz in the driver's setup program"});
}

void HdServo::start(OnTick on_tick) {
    schedule(std::move(on_tick), std::numeric_limits<std::int64_t>::max());
}

void HdServo::tick_once(OnTick on_tick) {
    schedule(std::move(on_tick), 1);
    end_ticks();
}

// Returns after the first tick.
void HdServo::schedule(OnTick on_tick, std::int64_t most_ticks) {
    end_ticks();
    start_scheduler();
    on_tick_ = std::move(on_tick);
    most_ticks_ = most_ticks;
    tick_ = {};
    ticks_ = last_ns_ = 0;
    ending_ = released_ = ticked_ = false;
    operation_ = api_.schedule_asynchronous(&HdServo::callback, this, highest_priority);
    scheduled_ = true;
    if (wait_for(ticked_, start_patience)) return;
    const HdErrorInfo error = take_hd_errors(api_);
    stop();
    if (error.code != success) throw SystemFailure(explain_hd_error("the device's scheduler", error));
    throw SystemFailure({"the device's scheduler", "it does not tick", "1000 times a second",
                         "unplug the device, plug it in again and start again; 'palpate doctor' says more"});
}

void HdServo::end_ticks() {
    if (!scheduled_) return;
    ending_.store(true);
    wait_for(released_, release_patience);
    api_.unschedule(operation_);
    // A driver that never comes out of the callback cannot be left: what it calls must stay.
    while (inside_.load()) std::this_thread::sleep_for(milliseconds(1));
    scheduled_ = false;
    take_hd_errors(api_);
}

void HdServo::stop() {
    end_ticks();
    if (!scheduler_runs_) return;
    api_.stop_scheduler();
    scheduler_runs_ = false;
    take_hd_errors(api_);
}

std::vector<SetupResult> HdServo::setup() const {
    std::vector<SetupResult> results;
    if (!devices_.empty() && devices_.front()->limits().rate_hz > 0)
        results.emplace_back(true, "the device's scheduler ticks 1000 times a second");
    std::ranges::copy(notes_, std::back_inserter(results));
    return results;
}

unsigned HdServo::callback(void* servo) noexcept {
    return static_cast<HdServo*>(servo)->tick();
}

// Either end_ticks() sees inside_ and waits, or this sees ending_ and does not tick.
unsigned HdServo::tick() noexcept {
    inside_.store(true);
    const bool last = ending_.load() || ticks_ == most_ticks_;
    if (!last) {
        time_tick();
        on_tick_(tick_);
        ticked_.store(true);
    } else if (!released_.load()) {
        release();
        released_.store(true);
    }
    inside_.store(false);
    return last ? callback_done : callback_continue;
}

void HdServo::time_tick() noexcept {
    const std::int64_t now = monotonic_ns();
    const std::int64_t gap = last_ns_ == 0 ? period_ns : now - last_ns_;
    last_ns_ = now;
    tick_.time = 1e-9 * static_cast<double>(++ticks_ * period_ns);
    tick_.wake_latency_ns = std::max<std::int64_t>(0, gap - period_ns);
    tick_.overruns += std::max<std::int64_t>(0, (gap + period_ns / 2) / period_ns - 1);
}

void HdServo::release() noexcept {
    for (HdDevice* device : devices_) device->read(0);
    for (HdDevice* device : devices_) device->write({});
}

}  // namespace palpate::devices
