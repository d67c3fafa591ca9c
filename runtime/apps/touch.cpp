// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <chrono>
#include <fstream>
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
#include "runtime/apps/replay.hpp"
#include "runtime/apps/run_record.hpp"
#include "runtime/apps/simulation.hpp"
#include "runtime/apps/start_recording.hpp"
#include "runtime/apps/statistics_json.hpp"
#include "runtime/apps/touch_json.hpp"
#include "runtime/apps/touch_target.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "runtime/realtime/process_age.hpp"
#include "tools/cli/command.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
    std::filesystem::path asset, log, curve, record, replay;
    std::string script = "press", body, target, second, scheme = "continuous", device, shaft;
    double seconds = 10, depth = 3, speed = 20, record_seconds = 300;
    std::uint64_t seed = 1;
    std::optional<std::size_t> column;
    bool seconds_given = false, virtual_clock = false;
};

// What the hand does, and where if that was chosen here.
struct Plan {
    HandPath path;
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

Plan plan_of(const Options& options, const Case& patient_case, const HapticModel& model) {
    if (!options.column && !is_made_to_measure(options.script)) {
        HandPath path = recorded_path(options.script);
        const double seconds = options.seconds_given ? options.seconds : path.duration();
        require_positive(seconds);
        return {std::move(path), std::nullopt, seconds};
    }
    if (!options.column) require_positive(options.seconds);
    const TouchTarget target =
        choose_touch_target(patient_case, model, options.body, point_of("--target", options.target));
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

// Ticks in the haptic thread while this one takes the results.
void run_in_real_time(ServoLoop& loop, double seconds, const std::function<void(const TickResult&)>& take) {
    TickResult result{};
    double time = 0;
    const auto pop = [&] {
        if (!loop.ring().pop(result)) return false;
        take(result);
        time = result.time;
        return true;
    };
    while (time < seconds)
        if (!pop()) std::this_thread::sleep_for(std::chrono::milliseconds(2));
    loop.stop();
    while (pop()) {
    }
}

// What a run leaves behind besides its recording: whole files or none.
class Outputs {
  public:
    Outputs(const Options& options, const cli::Session& session) : options_(options) {
        if (!options.log.empty()) {
            log_.open(log_file_.emplace(options.log, session.force).path());
            write_log_head(log_);
        }
        if (!options.curve.empty()) curve_file_.emplace(options.curve, session.force);
    }

    /// One for each tool.
    std::vector<RunRecord> records_of(const HapticModel& model) {
        return {model.tool_count(), RunRecord(model, log_file_ ? &log_ : nullptr)};
    }

    void commit(const RunRecord& first, const std::string& title) {
        if (log_file_) {
            log_.close();
            if (!log_)
                throw SystemFailure({options_.log.string(), "could not be written", "", "check free space"});
        }
        if (curve_file_) {
            curve_file_->write_text(force_curve_svg(first.curve(), title));
            curve_file_->commit();
        }
        if (log_file_) log_file_->commit();
    }

  private:
    const Options& options_;
    std::optional<cli::StagedFile> log_file_, curve_file_;
    std::ofstream log_;
};

// What a run was like, its recording says.
void refuse_others(const cli::Command& command, std::initializer_list<const CLI::Option*> of_a_replay) {
    for (const cli::Parameter& parameter : command.parameters())
        if (parameter.option->count() > 0 &&
            std::ranges::find(of_a_replay, parameter.option) == of_a_replay.end())
            throw UsageError({parameter.option->get_name(), "with --replay", "--log and --curve at most",
                              "a recording says itself what the run was like"});
}

std::string force_text(const std::array<double, 3>& f) {
    return fmt::format("({}, {}, {}) N", f[0], f[1], f[2]);
}

Json replay_recording(const Options& options, cli::Session& session) {
    Outputs outputs(options, session);
    const Recording recording = read_recording(options.replay);
    const Case patient_case = read_asset(options.asset);
    const auto model = model_of(recording, options.replay, options.asset, patient_case);
    std::vector<RunRecord> records = outputs.records_of(*model);
    const ReplayOutcome outcome = replay(recording, *model, [&](const TickResult& result) {
        records[static_cast<std::size_t>(result.tool)].add(result);
    });
    if (!outcome.started)
        throw InvalidInput({options.replay.string(), "no tick from which a replay could start",
                            "the run's first tick, or three in a row without contact, force and fault",
                            "record for longer: --record-seconds"});
    outputs.commit(records.front(), patient_case.name + ": replay");
    if (recording.rows_unreadable > 0)
        spdlog::warn("{}: {} rows at the end never reached the disk", options.replay.string(),
                     recording.rows_unreadable);
    if (*outcome.started > 0 || outcome.skipped_ticks > 0)
        spdlog::warn("{}: starts at tick {}; {} ticks are missing, {} were skipped for want of a free one",
                     options.replay.string(), *outcome.started, outcome.missing_ticks, outcome.skipped_ticks);
    if (const auto& first = outcome.first_difference)
        session.shortfall = {
            options.replay.string(),
            fmt::format("tick {} of tool {} gives {}; {} of {} ticks differ", first->tick, first->tool,
                        force_text(first->replayed), outcome.different_ticks, outcome.ticks),
            "the recorded " + force_text(first->recorded),
            "the recording is of palpate " + recording.head.palpate_version + ", this is " + cli::version()};
    Json result{{"case", patient_case.name},
                {"script", "replay"},
                {"scheme", recording.head.scheme},
                {"device", recording.head.devices.front().name},
                {"coupling_stiffness_n_per_mm", model->coupling()},
                {"clock", recording.head.clock},
                {"replay", replay_json(outcome)}};
    result.update(tool_json(records[0], patient_case, *model));
    if (records.size() > 1) result["second"] = tool_json(records[1], patient_case, *model);
    return result;
}

Json touch(const Options& options, cli::Session& session) {
    if (!options.replay.empty()) return replay_recording(options, session);
    Outputs outputs(options, session);
    const Case patient_case = load_asset(options.asset);
    const ContactScheme scheme = find_contact_scheme(options.scheme);
    if (!options.second.empty() && scheme != ContactScheme::continuous)
        throw UsageError({"--second", "with --scheme " + options.scheme, "the scheme 'continuous'",
                          "the published schemes know one tool"});
    HapticModel model(patient_case, scheme, options.second.empty() ? 1 : 2);
    const Plan plan = plan_of(options, patient_case, model);
    const std::array<double, 3> shaft = shaft_of(options, plan);
    std::vector<std::unique_ptr<Device>> devices;
    const Eigen::Vector3d up = plan.target ? plan.target->place.normal : anterior;
    devices.push_back(device_of(options, model, plan.path, up, shaft));
    if (!options.second.empty())
        devices.push_back(device_of(options, model, recorded_path(options.second), anterior, shaft));
    std::vector<Device*> held;
    for (const auto& device : devices) held.push_back(device.get());
    ServoLoop loop(model, held);

    const std::string clock = options.virtual_clock ? "virtual" : "real";
    std::optional<RunRecorder> recorder;
    if (!options.record.empty())
        recorder.emplace(start_recording(
            options.record, recording_head(options.asset, patient_case, model, held, clock, cli::version()),
            options.record_seconds, session));
    std::vector<RunRecord> records = outputs.records_of(model);
    const auto take = [&](const TickResult& result) {
        records[static_cast<std::size_t>(result.tool)].add(result);
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

    // A script's file name may name a patient.
    const std::string script = is_made_to_measure(options.script) ? options.script : "file";
    outputs.commit(records.front(), patient_case.name + ": " + script);

    const ServoStatistics statistics = loop.statistics();
    for (const SetupResult& setup : statistics.setup)
        if (!setup.ok) spdlog::warn("{}", setup.message);
    const std::uint64_t lost = options.virtual_clock ? 0 : statistics.lost_records;
    Json result{{"case", patient_case.name},
                {"script", script},
                {"scheme", options.scheme},
                {"device", devices.front()->name()},
                {"coupling_stiffness_n_per_mm", model.coupling()},
                {"clock", clock},
                {"ready_s", ready_s},
                {"ticks", statistics.ticks},
                {"overruns", statistics.overruns},
                {"lost_log_records", lost},
                {"tick_us", percentiles_json(statistics.tick_ns, 1e3)},
                {"wake_latency_us", percentiles_json(statistics.wake_latency_ns, 1e3)}};
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
         .summary = "Touches an asset with a simulated device at 1 kHz, without a window",
         .examples = {"palpate touch case.vtkhdf --script press --seconds 10 --log run.csv --curve force.svg",
                      "palpate touch case.vtkhdf --script hand.txt --json stats.json"},
         .notes =
             "Scripts: 'press' goes in along the surface's normal, holds 0.5 s and leaves, over and over; "
             "'slide' presses once and slides 4 mm to either side; 'tremble' presses and trembles there as "
             "a hand does, 8 to 12 Hz; 'let-go' presses, lets go of the device, and takes hold again "
             "outside; 'random' pushes, slides and leaves; a file has rows 'x y z' (mm), one per "
             "millisecond, or 't x y z' (s, mm); with --column N it is a recording of one axis at 1 kHz, "
             "which moves along the surface's normal. Without --device the hand is infinitely stiff: it is "
             "where the script says, whatever the force. A simulated device stands with the middle of its "
             "workspace where the hand starts, upright on the touched surface; for a path from a file its "
             "up is the patient's front. Schemes: 'continuous' sweeps the tool every tick; 'single' and "
             "'twice' are the published ones, with a collision loop at 30 Hz."});
    Options options;
    command.input("asset", options.asset, "the case (.vtkhdf)")->required();
    command.option("--script", options.script,
                   "what the hand does: press, slide, tremble, let-go, random or a file");
    command.option("--column", options.column,
                   "which column of the file, from 1, is one axis' motion: its smallest value clear of the "
                   "surface, its largest --depth deep");
             "Scripts: 'press' goes in along the surface's normal, holds 0.5 s and lets go, over and over; "
             "'slide' presses once and slides 4 mm to either side; 'random' pushes, slides and leaves; a "
             "file "
             "has rows 'x y z' (mm), one per millisecond, or 't x y z' (s, mm). Without --device the hand is "
             "infinitely stiff: it is where the script says, whatever the force. Schemes: 'continuous' "
             "sweeps "
             "the tool every tick; 'single' and 'twice' are the published ones, with a collision loop at 30 "
             "Hz. "
             "A recording has every tick of every tool, with its contacts, in a ring of the last "
             "--record-seconds (formats/recording/SPEC.md, for h5py); it has its name from the start and is "
             "kept however the run ends, where other outputs appear whole or not at all. A replay gives its "
             "forces again, bit for bit, or ends with exit code 4."});
    Options options;
    const CLI::Option* asset = command.input("asset", options.asset, "the case (.vtkhdf)")->required();
    command.option("--script", options.script, "what the hand does: press, slide, random or a file");
    const CLI::Option* seconds =
        command.option("--seconds", options.seconds, "how long; of a file, all unless this is given", "s");
    command.option("--depth", options.depth, "how deep the tool's surface goes below the rest surface", "mm");
    command.option("--speed", options.speed, "of press and slide", "mm/s");
    command.option("--body", options.body, "which body; the first deformable one if not given");
    command.option(
        "--target", options.target,
        "x,y,z: touch the surface point nearest to it; the most compliant place in reach if not given", "mm");
    command.option("--second", options.second,
                   "what a second tool on the same bodies does: a file as for --script");
    command.option("--scheme", options.scheme, "how contact is found: continuous, single or twice");
    command.option("--device", options.device,
                   "simulated device that gives way, in a hand that does: touch, desktop or premium");
    command.option(
        "--shaft", options.shaft,
        "x,y,z: direction from the tip along the shaft of both tools, for a case with one; straight out "
        "of the target if not given, and with a file none, so that the tip alone is felt");
    command.option("--seed", options.seed, "of the scripts 'random' and 'tremble'");
    command.output("--log", options.log, "one row per tick (.csv)");
    command.output("--curve", options.curve, "force and depth of the first tool over time (.svg)");
    command.option("--seed", options.seed, "of the script 'random'");
    const CLI::Option* log = command.output("--log", options.log, "one row per tick (.csv)");
    const CLI::Option* curve =
        command.output("--curve", options.curve, "force and depth of the first tool over time (.svg)");
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
        if (replay->count() > 0) refuse_others(command, {asset, log, curve, replay});
        return touch(options, session);
    });
}
