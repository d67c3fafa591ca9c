// SPDX-License-Identifier: Apache-2.0
#include <atomic>
#include <chrono>
#include <fmt/format.h>
#include <span>
#include <thread>

#include "formats/asset/asset.hpp"
#include "runtime/doctor/checks/case_checks.hpp"
#include "runtime/doctor/checks/device_checks.hpp"
#include "runtime/doctor/checks/environment_checks.hpp"
#include "runtime/doctor/checks/library_checks.hpp"
#include "runtime/doctor/checks/realtime_checks.hpp"
#include "runtime/doctor/report.hpp"
#include "runtime/doctor/wake_ups.hpp"
#include "runtime/realtime/servo.hpp"
#include "runtime/session/device_list.hpp"
#include "runtime/session/statistics_json.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {
namespace {

using namespace devices;
using namespace doctor;
using namespace realtime;
using namespace session;

using Json = nlohmann::ordered_json;

struct Options {
    std::filesystem::path asset;
    std::string device;
    double seconds = 3;
    bool simulated = false;
};

void append(Findings& findings, Findings more) {
    findings.insert(findings.end(), std::make_move_iterator(more.begin()),
                    std::make_move_iterator(more.end()));
}

// Whether there is anything in a device to look at.
bool can_be_examined(const DeviceKind& kind) {
    return !kind.simulated && kind.renders_force;
}

// Opens devices and looks at their first half second; no force is rendered.
Findings opened_device_findings(const DeviceChoice& asked) {
    constexpr std::size_t ticks = 500;
    Findings findings;
    try {
        const OpenDevices open = asked.open({.tools = std::vector<HeldTool>(asked.tool_count), .limits = {}});
        const auto& devices = open.devices;
        PeriodicServo own_servo;
        Servo& servo = open.servo ? *open.servo : own_servo;
        std::vector<std::vector<DeviceState>> states(devices.size(), std::vector<DeviceState>(ticks));
        std::atomic<std::size_t> seen{0};
        servo.start([&](const ServoTick& wake) {
            const std::size_t tick = seen.load();
            for (std::size_t i = 0; i < devices.size(); ++i) {
                const DeviceState state = devices[i]->read(wake.time);
                if (tick < ticks) states[i][tick] = state;
            }
            for (const auto& device : devices) device->write({});
            if (tick < ticks) seen.store(tick + 1);
        });
        for (int i = 0; i < 200 && seen.load() < ticks && !cli::interrupt_asked(); ++i)
            std::this_thread::sleep_for(std::chrono::milliseconds(10));
        servo.stop();
        if (cli::interrupt_asked()) throw cli::Interrupted();
        for (std::size_t i = 0; i < devices.size(); ++i)
            append(findings,
                   device_findings({devices[i]->name(), devices[i]->calibration(), devices[i]->limits(),
                                    std::span(states[i]).first(seen.load())}));
    } catch (const Error& error) {
        findings.push_back(
            {"device", "device", Level::problem, error.what(), "# " + error.detail().next_step});
    }
    return findings;
}

Json measured_json(const WakeUps& wake_ups) {
    return {{"real_time", wake_ups.real_time},
            {"deadlines", wake_ups.late_ns.count()},
            {"missed", wake_ups.missed},
            {"wake_latency_us", percentiles_json(wake_ups.late_ns, 1e3)}};
}

Json examine(const Options& options, cli::Session& session) {
    if (!(options.seconds >= 0.1 && options.seconds <= 3600))
        throw UsageError({"--seconds", fmt::format("{}", options.seconds), "0.1 to 3600", ""});
    const DeviceChoice device = choose_device(options.device, "--device");
    const bool asked = !options.device.empty();
    if (asked && !can_be_examined(device.kind))
        throw UsageError({"--device", options.device, device_usages(can_be_examined, true), ""});
    std::optional<Case> patient_case;
    if (!options.asset.empty()) patient_case = asset::read_asset(options.asset);
    const Purpose purpose = options.simulated ? Purpose::simulation : Purpose::device;
    const Machine machine = this_machine();
    Findings findings = realtime_findings(machine, purpose);
    const WakeUps servo = measure_servo(options.seconds);
    const WakeUps without = measure_without_priority(options.seconds);
    append(findings, wake_up_findings(servo, without, purpose));
    if (purpose == Purpose::device) append(findings, library_findings(machine));
    append(findings, environment_findings(machine, purpose));
    if (purpose == Purpose::device) append(findings, usb_findings(machine, find_usb_devices(machine)));
    if (asked) {
        cli::end_softly_on_interrupt();
        append(findings, opened_device_findings(device));
    }
    if (patient_case) append(findings, case_findings(*patient_case));

    const std::size_t problems = count(findings, Level::problem), warnings = count(findings, Level::warning);
    const std::string ready_for = options.simulated ? "the simulated device" : "a device";
    session.text = fmt::format("{}\n{} for {}; problems: {}, warnings: {}\n", report_text(findings),
                               problems == 0 ? "ready" : "not ready", ready_for, problems, warnings);
    if (problems > 0)
        session.shortfall = ErrorDetail{"this machine", fmt::format("not ready for {}", ready_for), "",
                                        "mend the problems above and run this again"};
    return {{"ready_for", options.simulated ? "simulation" : "device"},
            {"ready", problems == 0},
            {"problems", problems},
            {"warnings", warnings},
            {"rate_held_hz", rate_held(servo)},
            {"measured", {{"servo", measured_json(servo)}, {"without_priority", measured_json(without)}}},
            {"findings", report_json(findings, machine)}};
}

}  // namespace
}  // namespace palpate::apps

int main(int argc, char** argv) {
    using namespace palpate;
    using namespace palpate::apps;
    cli::Command command(
        {.name = "doctor",
         .summary = "Examines this machine: real-time permissions, timing, device library, surroundings",
         .examples = {"palpate doctor case.vtkhdf", "palpate doctor --simulated --json machine.json"},
         .notes =
             "Each finding is ok, a warning or a problem, and what is wrong comes with shell lines that mend "
             "it. Exits with 0 if nothing is a problem, warnings or not, and with 4 if this machine is not "
             "ready for a device. Where there is no device, as in continuous integration, --simulated leaves "
             "out what only a device needs and takes a refused real-time priority for a warning. The rate "
             "held is the highest of 1000, 500 and 250 Hz whose period is longer than what 99.9 % of the "
             "wake-ups are late by and 100 us for the tick. A device is opened only with --device: its "
             "calibration, its first pose and its workspace are looked at, and it renders no force. JSON is "
             "for support: it "
             "names neither user nor machine nor home."});
    Options options;
    command.input("case", options.asset, "hold this case (.vtkhdf) against each device");
    command.option("--seconds", options.seconds, "of each of the two measurements, 0.1 to 3600", "s");
    command.option("--device", options.device,
                   "also open this one for half a second: " + device_usages(can_be_examined, true));
    command.flag("--simulated", options.simulated,
                 "ask only for what the simulated device needs, and for what --device names");
    return command.run(argc, argv, [&](cli::Session& session) { return examine(options, session); });
}
