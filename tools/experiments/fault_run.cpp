// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/fault_run.hpp"

#include <algorithm>
#include <cmath>
#include <limits>

#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "runtime/session/touch_target.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using namespace haptics;
using namespace realtime;
using namespace session;
using Eigen::Vector3d;

constexpr double limit_rounding = 1e-12;  // relative
constexpr std::array kinds{invalid_position, device_lost, not_calibrated, pose_frozen,  motors_warm,
                           device_refused,   tick_late,   visual_stopped, asset_removed};

// The injection that a tick falls into; null if none.
const Injection* at(const std::vector<Injection>& injections, std::int64_t tick) {
    const auto after = std::ranges::upper_bound(injections, tick, {}, &Injection::from);
    if (after == injections.begin()) return nullptr;
    const Injection& last = *std::prev(after);
    return tick < last.until ? &last : nullptr;
}

// A device to which injections happen.
class FaultyDevice final : public Device {
  public:
    FaultyDevice(Device& device, const std::vector<Injection>& injections)
        : device_(device), injections_(injections) {}

    std::string name() const override { return device_.name() + ", with faults"; }
    DeviceLimits limits() const override { return device_.limits(); }
    DeviceState read(double time) noexcept override {
        DeviceState state = device_.read(time);
        const Injection* injection = at(injections_, ++tick_);
        if (!injection || !(injection->fault & (distrusted_position | motors_warm | device_refused))) {
            last_ = state;
            return state;
        }
        if (injection->fault == invalid_position)
            state.position[tick_ % 3] = std::numeric_limits<double>::quiet_NaN();
        else
            state.faults |= injection->fault;
        if (injection->fault == device_lost) state.position = last_.position;
        if (injection->fault == not_calibrated) state.position[0] += 50;
        if (injection->fault == pose_frozen) state.position = {0, -110, -35};
        return state;
    }
    void write(const Wrench& wrench) noexcept override { device_.write(wrench); }

  private:
    Device& device_;
    const std::vector<Injection>& injections_;
    DeviceState last_;
    std::int64_t tick_ = 0;
};

// Holds each tick against the limits.
class Watch {
  public:
    Watch(const HapticModel& model, double max_force, FaultRun& run)
        : max_force_(max_force), max_step_(model.settings().max_force_rate), run_(run) {}

    void add(const TickResult& result, const Injection* injection, std::int64_t tick) {
        const Vector3d force = Eigen::Map<const Vector3d>(result.force.data());
        const double step = (force - last_).norm();
        ++run_.ticks;
        run_.pressing += force.norm() > 0;
        run_.not_finite += !force.allFinite();
        run_.above_limit += force.norm() > max_force_ * (1 + limit_rounding);
        run_.above_slew += step > max_step_ * (1 + limit_rounding);
        run_.not_gone += injection && tick - injection->from >= ForceLimiter::ramp_ticks && !force.isZero(0);
        run_.strongest = std::max(run_.strongest, force.norm());
        run_.largest_step = std::max(run_.largest_step, step);
        if (result.status & coming_back)
            run_.largest_growth = std::max(run_.largest_growth, force.norm() - last_.norm());
        last_ = force;
    }

  private:
    double max_force_, max_step_;
    FaultRun& run_;
    Vector3d last_ = Vector3d::Zero();
};

HandPath path_at_random(const Case& patient_case, const HapticModel& model, double seconds,
                        std::mt19937_64& random) {
    std::vector<std::size_t> bodies(model.body_count());
    const std::size_t body = std::uniform_int_distribution<std::size_t>(0, bodies.size() - 1)(random);
    const TouchTarget target = choose_touch_target(patient_case, model, model.body_name(body), {});
    return random_path(target.place,
                       {.tool_radius = model.contact_radius(), .depth = 6, .speed = 60, .seconds = seconds},
                       random());
}

}  // namespace

std::vector<Injection> draw_injections(std::int64_t ticks, std::mt19937_64& random) {
    std::uniform_int_distribution<std::int64_t> pause(1200, 20'000), length(1, 2000);
    std::uniform_int_distribution<std::size_t> kind(0, kinds.size() - 1);
    std::vector<Injection> injections;
    for (std::int64_t from = pause(random); from + 2000 < ticks;) {
        const Fault fault = kinds[kind(random)];
        const std::int64_t until = from + (fault == tick_late ? 1 : length(random));
        injections.push_back({fault, from, until});
        from = until + pause(random);
    }
    return injections;
}

void FaultRun::add(const FaultRun& other) {
    ticks += other.ticks;
    pressing += other.pressing;
    for (const auto& [name, count] : other.injected) injected[name] += count;
    reported += other.reported;
    missed += other.missed;
    unexpected += other.unexpected;
    above_limit += other.above_limit;
    above_slew += other.above_slew;
    not_finite += other.not_finite;
    not_gone += other.not_gone;
    strongest = std::max(strongest, other.strongest);
    largest_step = std::max(largest_step, other.largest_step);
    largest_growth = std::max(largest_growth, other.largest_growth);
}

FaultRun run_with_faults(const Case& patient_case, std::string_view method, const DeviceModel& device_model,
                         const std::vector<Injection>& injections, std::int64_t ticks,
                         std::mt19937_64& random) {
    HapticModel model(patient_case, method);
    DynamicDevice device(device_model, HandImpedance{},
                         path_at_random(patient_case, model, 1e-3 * static_cast<double>(ticks), random));
    FaultyDevice faulty(device, injections);
    ServoLoop loop(model, faulty);
    FaultRun run;
    FaultLog log;
    Watch watch(model, std::min(model.settings().max_force, device_model.max_force), run);
    std::uniform_int_distribution<std::int64_t> skipped(ServoLoop::late_periods, 2000);
    std::int64_t now = 0, overruns = 0;
    loop.run_virtual(
        ticks,
        [&](const TickResult& result) {
            watch.add(result, at(injections, now), now);
            TickResult told = result;
            told.time = 1e-3 * static_cast<double>(now);  // of the injections
            log.add(told);
        },
        [&](std::int64_t tick) {
            now = tick;
            const Injection* injection = at(injections, tick);
            const Fault fault = injection ? injection->fault : no_fault;
            for (const Fault told : {visual_stopped, asset_removed}) loop.set_fault(told, fault == told);
            if (fault != tick_late)
                return ServoTick{1e-9 * static_cast<double>((tick + overruns) * ServoLoop::period_ns), 0,
                                 overruns};
            // Woken late, as a process that was stopped; the periods are counted as skipped at the next one.
            const std::int64_t late = skipped(random);
            const ServoTick wake{1e-9 * static_cast<double>((tick + overruns) * ServoLoop::period_ns),
                                 late * ServoLoop::period_ns, overruns};
            overruns += late;
            return wake;
        });

    run.reported = static_cast<std::int64_t>(log.events().size());
    for (const Injection& injection : injections) {
        ++run.injected[fault_names(injection.fault)];
        const auto told = std::ranges::count_if(log.events(), [&](const FaultEvent& event) {
            return event.fault == injection.fault && std::llround(1000 * event.from) == injection.from;
        });
        run.missed += told == 0;
    }
    for (const FaultEvent& event : log.events())
        run.unexpected += std::ranges::none_of(injections, [&](const Injection& injection) {
            return event.fault == injection.fault && std::llround(1000 * event.from) == injection.from;
        });
    return run;
}

}  // namespace palpate::experiments
