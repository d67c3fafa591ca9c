// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <sstream>
#include <thread>
#include <vector>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"
#include "runtime/apps/hand_script.hpp"
#include "runtime/apps/live_stream.hpp"
#include "runtime/apps/physical_devices.hpp"
#include "runtime/apps/run_record.hpp"
#include "runtime/apps/run_recorder.hpp"
#include "runtime/apps/run_watch.hpp"
#include "runtime/apps/simulation.hpp"
#include "runtime/apps/start_recording.hpp"
#include "runtime/apps/statistics_json.hpp"
#include "runtime/apps/touch_json.hpp"
#include "runtime/apps/touch_outputs.hpp"
#include "runtime/apps/touch_replay.hpp"
#include "runtime/apps/touch_target.hpp"
#include "runtime/devices/mounted_device.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "runtime/realtime/process_age.hpp"
#include "tools/cli/command.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
    std::filesystem::path asset, log, curve, record, replay;
    std::string script = "press", body, target, second, scheme = "continuous", device, shaft, stream;
    double seconds = 10, depth = 3, speed = 20, record_seconds = 300;
    std::uint64_t seed = 1;
    std::optional<std::size_t> column;
    bool seconds_given = false, virtual_clock = false;
    std::vector<std::string> of_the_hand;  // names of the options given that say what a simulated hand does
};

// What the hand does, and where if that was chosen here.
struct Plan {
    std::optional<HandPath> path;  // none where a person's hand moves
    std::optional<TouchTarget> target;
    double seconds;
};

std::optional<Eigen::Vector3d> point_of(const char* option, std::string text) {
    if (text.empty()) return std::nullopt;
    std::istringstream stream(text);
    Eigen::Vector3d p;
    char comma = ',', other_comma = ',';
    stream >> p[0] >> comma >> p[1] >> other_comma >> p[2];
    if (!stream || comma != ',' || other_comma != ',' || stream.peek() != EOF)
        throw UsageError({option, text, "x,y,z", ""});
    return p;
}

// At least one tick, so that there is something to report.
void require_positive(double seconds) {
    if (!(seconds >= 1e-3)) throw UsageError({"--seconds", std::to_string(seconds), "0.001 or more", ""});
}

Plan plan_of(const Options& options, bool physical, const Case& patient_case, const HapticModel& model) {
    if (!physical && !options.column && !is_made_to_measure(options.script)) {
        HandPath path = recorded_path(options.script);
        const double seconds = options.seconds_given ? options.seconds : path.duration();
        require_positive(seconds);
        return {std::move(path), std::nullopt, seconds};
    }
    if (!options.column) require_positive(options.seconds);
    const TouchTarget target =
        choose_touch_target(patient_case, model, options.body, point_of("--target", options.target));
    if (physical) return {std::nullopt, target, options.seconds};
    // The published schemes know the tip's centre alone.
    const bool has_radius = model.scheme() == ContactScheme::continuous;
    const ScriptSettings settings{.tool_radius = has_radius ? model.settings().tool_radius : 0,
                                  .depth = options.depth,
                                  .speed = options.speed,
                                  .seconds = options.seconds};
    if (!options.column)
        return {made_to_measure_path(options.script, target.place, settings, options.seed), target,
                options.seconds};
    HandPath path = recorded_axis_path(options.script, *options.column, target.place, settings);
    const double seconds = options.seconds_given ? options.seconds : path.duration();
    require_positive(seconds);
    return {std::move(path), target, seconds};
}

// From the tip along the shaft: as asked, or straight out of the place that is touched.
std::array<double, 3> shaft_of(const Options& options, const Plan& plan) {
    Eigen::Vector3d along = plan.target ? plan.target->place.normal : Eigen::Vector3d::Zero();
    if (const auto asked = point_of("--shaft", options.shaft)) {
        if (!(asked->norm() > 0)) throw UsageError({"--shaft", options.shaft, "a direction", ""});
        along = asked->normalized();
    }
    return {along[0], along[1], along[2]};
}

// `up`: which way out of the patient a device of its own frame is turned.
std::unique_ptr<Device> device_of(const Options& options, const HapticModel& model, HandPath path,
                                  const Eigen::Vector3d& up, const std::array<double, 3>& shaft) {
    if (!options.device.empty()) return simulate(find_device_model(options.device), path, up, shaft);
    const DeviceLimits limits{.max_force = model.settings().max_force,
                              .max_stiffness = model.settings().coupling_stiffness};
    return std::make_unique<SimulatedDevice>(std::move(path), limits, shaft);
}

// The devices of a run, one for each tool.
struct Held {
    std::unique_ptr<PhysicalDevices> physical;
    std::vector<std::unique_ptr<Device>> simulated;
    std::vector<Device*> devices;
    Servo* servo = nullptr;  // null: the loop's own
};

Held hold(const Options& options, const std::optional<PhysicalDevice>& physical, const Plan& plan,
          const HapticModel& model) {
    Held held;
    const Eigen::Vector3d up = plan.target ? plan.target->place.normal : anterior;
    if (physical) {
        const Eigen::Vector3d start = start_outside(plan.target->place, model.settings().tool_radius);
        held.physical = std::make_unique<PhysicalDevices>(*physical, start, upright(up));
        held.devices = held.physical->devices();
        held.servo = held.physical->servo();
        return held;
    }
    const std::array<double, 3> shaft = shaft_of(options, plan);
    held.simulated.push_back(device_of(options, model, *plan.path, up, shaft));
    if (!options.second.empty())
        held.simulated.push_back(device_of(options, model, recorded_path(options.second), anterior, shaft));
    for (const auto& device : held.simulated) held.devices.push_back(device.get());
    return held;
}

// Ticks in the haptic thread while this one takes the results, until the time is over or the user asks.
void run_in_real_time(ServoLoop& loop, double seconds, const std::function<void(const TickResult&)>& take) {
    constexpr std::chrono::seconds patience{5};
    TickResult result{};
    auto last_tick = std::chrono::steady_clock::now();
    const auto pop = [&] {
        if (!loop.ring().pop(result)) return false;
        take(result);
        return true;
    };
    while (result.time < seconds && !cli::interrupt_asked()) {
        const auto now = std::chrono::steady_clock::now();
        if (pop())
            last_tick = now;
        else if (now - last_tick > patience)
            throw SystemFailure({"the servo", "has not ticked for 5 s", "1000 ticks a second",
                                 "check the device's cable, then 'palpate doctor'"});
        else
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    loop.stop();
    while (pop()) {
    }
}

// A combination of options that makes no sense, with what to do.
void refuse_contradictions(const Options& options, const std::optional<PhysicalDevice>& physical) {
    const bool continuous = find_contact_scheme(options.scheme) == ContactScheme::continuous;
    if (!options.second.empty() && !continuous)
        throw UsageError({"--second", "with --scheme " + options.scheme, "the scheme 'continuous'",
                          "the published schemes know one tool"});
    if (options.virtual_clock && !options.stream.empty())
        throw UsageError({"--stream", "with --virtual-clock", "the real clock", ""});
    if (!physical) return;
    const std::string with = "with --device " + options.device;
    if (options.virtual_clock)
        throw UsageError({"--virtual-clock", with, "the real clock", "a hand keeps its own time"});
    if (!options.second.empty())
        throw UsageError({"--second", with, "--device openhaptics:NAME,NAME", "a hand holds each device"});
    if (!options.of_the_hand.empty())
        throw UsageError({options.of_the_hand.front(), with, "a simulated device", "a hand moves this one"});
}

Json touch(const Options& options, cli::Session& session) {
    TouchOutputs outputs(options.log, options.curve, session);
    if (!options.replay.empty()) return replay_recording(options.replay, options.asset, outputs, session);
    const std::optional<PhysicalDevice> physical = parse_physical_device(options.device);
    refuse_contradictions(options, physical);
    const Case patient_case = load_asset(options.asset);
    const std::size_t simulated_tools = options.second.empty() ? 1 : 2;
    HapticModel model(patient_case, find_contact_scheme(options.scheme),
                      physical ? physical->tool_count() : simulated_tools);
    const Plan plan = plan_of(options, physical.has_value(), patient_case, model);
    if (!options.virtual_clock) cli::end_softly_on_interrupt();
    const Held held = hold(options, physical, plan, model);
    ServoLoop loop(model, held.devices, held.servo);

    const std::string clock = options.virtual_clock ? "virtual" : "real";
    // Before the recording, which stays whatever happens then.
    std::optional<LiveStream> stream;
    if (!options.stream.empty()) stream.emplace(options.stream, patient_case, model.tool_count());
    std::optional<RunRecorder> recorder;
    if (!options.record.empty())
        recorder.emplace(start_recording(
            options.record,
            recording_head(options.asset, patient_case, model, held.devices, clock, cli::version()),
            options.record_seconds, session));
    std::vector<RunRecord> records = outputs.records_of(model);
    RunWatch watch(options.asset, loop, [](const std::string& sentence) { spdlog::warn("{}", sentence); });
    const auto take = [&](const TickResult& result) {
        records[static_cast<std::size_t>(result.tool)].add(result);
        watch.add(result);
        if (stream) stream->show(result);
        if (!recorder) return;
        recorder->add(result);
        if (!options.virtual_clock) recorder->set_lost(loop.ring().dropped());
    };
    double ready_s = 0;
    if (options.virtual_clock) {
        ready_s = process_age();
        loop.run_virtual(static_cast<std::int64_t>(1000 * plan.seconds), take);
    } else {
        loop.start();
        ready_s = process_age();
        run_in_real_time(loop, plan.seconds, take);
    }
    if (cli::interrupt_asked()) {
        spdlog::warn("interrupted: the force has gone to zero, only a recording is kept");
        throw cli::Interrupted();
    }

    // A script's file name may name a patient.
    const std::string script = physical                             ? "none"
                               : is_made_to_measure(options.script) ? options.script
                                                                    : "file";
    outputs.commit(records.front(), patient_case.name + ": " + (physical ? options.device : script));

    const ServoStatistics statistics = loop.statistics();
    for (const SetupResult& setup : statistics.setup)
        if (!setup.ok) spdlog::warn("{}", setup.message);
    const std::uint64_t lost = options.virtual_clock ? 0 : statistics.lost_records;
    Json result{{"case", patient_case.name},
                {"script", script},
                {"scheme", options.scheme},
                {"device", held.devices.front()->name()},
                {"coupling_stiffness_n_per_mm", model.coupling()},
                {"clock", clock},
                {"ready_s", ready_s},
                {"ticks", statistics.ticks},
                {"overruns", statistics.overruns},
                {"lost_log_records", lost},
                {"tick_us", percentiles_json(statistics.tick_ns, 1e3)},
                {"wake_latency_us", percentiles_json(statistics.wake_latency_ns, 1e3)},
                {"faults", watch.faults_json()}};
    if (recorder) result["recording"] = {{"rows", recorder->rows()}, {"lost_rows", lost}};
    if (plan.target) result["target"] = target_json(*plan.target, model);
    result.update(tool_json(records[0], patient_case, model));
    if (records.size() > 1) result["second"] = tool_json(records[1], patient_case, model);
    return result;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    using namespace palpate;
    cli::Command command(
        {.name = "touch",
         .summary = "Touches an asset at 1 kHz with a simulated or a real device, without a window",
         .examples = {"palpate touch case.vtkhdf --script press --seconds 10 --log run.csv --curve force.svg",
                      "palpate touch case.vtkhdf --script hand.txt --json stats.json"},
         .notes =
             "Scripts: 'press' goes in along the surface's normal, holds 0.5 s and leaves, over and over; "
             "'slide' presses once and slides 4 mm to either side; 'tremble' presses and trembles there as "
             "a hand does, 8 to 12 Hz; 'let-go' presses, lets go of the device, and takes hold again "
             "outside; 'random' pushes, slides and leaves; a file has rows 'x y z' (mm), one per "
             "millisecond, or 't x y z' (s, mm); with --column N it is a recording of one axis at 1 kHz, "
             "which moves along the surface's normal. Without --device the hand is infinitely stiff: it is "
             "where the script says, whatever the force.\n"
             "Devices: touch, desktop and premium are simulated, in a hand that gives way; openhaptics, "
             "openhaptics:NAME and openhaptics:NAME,NAME (one tool each) are Phantoms and Touches on the "
             "driver's library, which PALPATE_HD_LIBRARY may name; igtl:HOST:PORT or igtl:HOST:PORT/NAME is "
             "a tracker's tool over OpenIGTLink, without force. A device stands with the middle of its "
             "workspace where the hand starts, upright on the touched surface; for a path from a file its "
             "up is the patient's front. 'palpate doctor' says what a device lacks.\n"
             "Schemes: 'continuous' sweeps the tool every tick; 'single' and 'twice' are the published "
             "ones, with a collision loop at 30 Hz.\n"
             "A recording has every tick of every tool, with its contacts, in a ring of the last "
             "--record-seconds (formats/recording/SPEC.md, for h5py); it has its name from the start and is "
             "kept however the run ends, where other outputs appear whole or not at all. A replay gives its "
             "forces again, bit for bit, or ends with exit code 4."});
    Options options;
    const CLI::Option* asset = command.input("asset", options.asset, "the case (.vtkhdf)")->required();
    const CLI::Option* script = command.option(
        "--script", options.script, "what the hand does: press, slide, tremble, let-go, random or a file");
    const CLI::Option* column = command.option(
        "--column", options.column,
        "which column of the file, from 1, is one axis' motion: its smallest value clear of the "
        "surface, its largest --depth deep");
    const CLI::Option* seconds =
        command.option("--seconds", options.seconds, "how long; of a file, all unless this is given", "s");
    const CLI::Option* depth = command.option(
        "--depth", options.depth, "how deep the tool's surface goes below the rest surface", "mm");
    const CLI::Option* speed = command.option("--speed", options.speed, "of press and slide", "mm/s");
    command.option("--body", options.body, "which body; the first deformable one if not given");
    command.option(
        "--target", options.target,
        "x,y,z: touch the surface point nearest to it; the most compliant place in reach if not given", "mm");
    command.option("--second", options.second,
                   "what a second tool on the same bodies does: a file as for --script");
    command.option("--scheme", options.scheme, "how contact is found: continuous, single or twice");
    command.option("--device", options.device,
                   "touch, desktop, premium, openhaptics[:NAME[,NAME]] or igtl:HOST:PORT[/NAME]");
    const CLI::Option* shaft = command.option(
        "--shaft", options.shaft,
        "x,y,z: direction from the tip along the shaft of both tools, for a case with one; straight out "
        "of the target if not given, and with a file none, so that the tip alone is felt");
    const CLI::Option* seed = command.option("--seed", options.seed, "of the scripts 'random' and 'tremble'");
    const CLI::Option* log = command.output("--log", options.log, "one row per tick (.csv)");
    const CLI::Option* curve =
        command.output("--curve", options.curve, "force and depth of the first tool over time (.svg)");
    command.option("--stream", options.stream,
                   "PORT or ADDRESS:PORT at which 3D Slicer and others see the session over OpenIGTLink");
    command.output("--record", options.record, "every tick, from the start on (.h5)");
    command.option("--record-seconds", options.record_seconds,
                   "how much of the run's end a recording holds: 46 MB a minute and tool", "s");
    const CLI::Option* replay = command.input(
        "--replay", options.replay,
        "recording to give the forces of again, as fast as possible; no option of a run goes with it (.h5)");
    command.flag("--virtual-clock", options.virtual_clock,
                 "tick as fast as possible; forces do not depend on the machine");
    return command.run(argc, argv, [&](cli::Session& session) {
        options.seconds_given = seconds->count() > 0;
        for (const CLI::Option* option : {script, column, depth, speed, shaft, seed})
            if (option->count() > 0) options.of_the_hand.push_back(option->get_name());
        if (replay->count() > 0) refuse_beside_replay(command, {asset, log, curve, replay});
        return touch(options, session);
    });
}
