// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <chrono>
#include <spdlog/spdlog.h>
#include <thread>
#include <vector>

#include "formats/asset/hdf5/signature.hpp"
#include "formats/model/errors.hpp"
#include "runtime/apps/options/large_option.hpp"
#include "runtime/apps/servo_pulse.hpp"
#include "runtime/apps/start_recording.hpp"
#include "runtime/apps/tell_statuses.hpp"
#include "runtime/apps/touch_json.hpp"
#include "runtime/apps/touch_outputs.hpp"
#include "runtime/apps/touch_plan.hpp"
#include "runtime/apps/touch_replay.hpp"
#include "runtime/realtime/process_age.hpp"
#include "runtime/session/hand_script.hpp"
#include "runtime/session/run_record.hpp"
#include "runtime/session/session.hpp"
#include "runtime/session/statistics_json.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/refuse_beside.hpp"

namespace palpate::apps {
namespace {

using namespace haptics;
using namespace session;

using Json = nlohmann::ordered_json;

// Ticks in the haptic thread while this one takes the results, until the time is over or the user asks.
void run_in_real_time(Session& run, double seconds, const Session::Sink& take) {
    ServoPulse pulse;
    double time = 0;
    std::int64_t tick = 0;
    const Session::Sink see = [&](const TickResult& result) {
        time = result.time;
        tick = result.tick;
        take(result);
    };
    while (time < seconds && !cli::interrupt_asked()) {
        run.pump(see);
        pulse.see(tick);
        std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    run.stop();
    run.pump(see);
}

Json touch(const TouchOptions& options, cli::Session& session) {
    if (!options.record.empty()) cli::seekable_target(options.record);
    TouchOutputs outputs(options.log, options.curve, session);
    const auto trusted = asset::read_public_keys(options.trusted);
    if (!options.replay.empty())
        return replay_recording(options.replay, options.asset, trusted, outputs, session);
    const DeviceChoice device = choose_device(options.device, "--device");
    refuse_contradictions(options, device);
    Session run({.asset = options.asset,
                 .method = options.scheme,
                 .tool_count = tools_of(options, device),
                 .virtual_clock = options.virtual_clock,
                 .trusted_keys = trusted,
                 .tool = tool_body(options.tool),
                 .jaws = jaws_of(options.tool),
                 .hyperelastic = options.hyperelastic,
                 .stream = options.stream},
                [](const std::string& sentence) { spdlog::warn("{}", sentence); });
    const Case& patient_case = run.patient_case();
    const HapticModel& model = run.model();
    tell_unfelt(patient_case, options.scheme);
    const TouchPlan plan = plan_of(options, device.kind, patient_case, model);
    if (!options.virtual_clock) cli::end_softly_on_interrupt();
    run.hold(device.open(request_of(options, device.kind, plan, model)),
             plan.grasp ? plan.grasp->grasp.orientation : Eigen::Quaterniond::Identity());
    if (!options.device.empty()) tell_torque(run.model(), run.device_name());
    tell_too_weak(patient_case, run.device_name());
    if (!options.record.empty()) start_recording(run, options.record, options.record_seconds, session);
    std::vector<RunRecord> records = outputs.records_of(model);
    const auto take = [&](const TickResult& result) { records[result.tool].add(result); };
    if (!options.virtual_clock) run.start();
    const double ready_s = realtime::process_age();
    if (options.virtual_clock)
        run.run_virtual(plan.seconds, take);
    else
        run_in_real_time(run, plan.seconds, take);
    if (cli::interrupt_asked()) {
        spdlog::warn("interrupted: the force has gone to zero, only a recording is kept");
        throw cli::Interrupted();
    }

    // A script's file name may name a patient.
    const std::string script = !device.kind.simulated               ? "none"
                               : is_made_to_measure(options.script) ? options.script
                                                                    : "file";
    outputs.commit(records.front(),
                   patient_case.name + ": " + (device.kind.simulated ? script : options.device));

    const ServoStatistics statistics = run.statistics();
    for (const realtime::SetupResult& setup : statistics.setup)
        if (!setup.ok) spdlog::warn("{}", setup.message);
    tell_statuses(run.statuses());
    tell_misfit(records.front().statuses(), statistics.ticks);
    Json result{{"case", patient_case.name},
                {"script", script},
                {"scheme", options.scheme},
                {"large_deformation", run.deforming_far()},
                {"device", run.device_name()},
                {"coupling_stiffness_n_per_mm", model.coupling()},
                {"torque_is_felt", model.torque_is_felt()},
                {"clock", options.virtual_clock ? "virtual" : "real"},
                {"ready_s", ready_s},
                {"ticks", statistics.ticks},
                {"overruns", statistics.overruns},
                {"lost_log_records", statistics.lost_records},
                {"tick_us", percentiles_json(statistics.tick_ns, 1e3)},
                {"wake_latency_us", percentiles_json(statistics.wake_latency_ns, 1e3)},
                {"faults", run.faults_json()}};
    if (const auto rows = run.recorded_rows())
        result["recording"] = {{"rows", *rows}, {"lost_rows", statistics.lost_records}};
    if (plan.target) result["target"] = target_json(*plan.target, model);
    if (plan.grasp) result["grasp"] = grasp_json(*plan.grasp, model);
    result.update(tool_json(records[0], patient_case, model));
    if (records.size() > 1) result["second"] = tool_json(records[1], patient_case, model);
    return result;
}

}  // namespace
}  // namespace palpate::apps

int main(int argc, char** argv) {
    using namespace palpate;
    using namespace palpate::apps;
    cli::Command command(
        {.name = "touch",
         .summary = "Touches an asset at 1 kHz with a simulated or a real device, without a window",
         .examples = {"palpate touch case.vtkhdf --script press --seconds 10 --log run.csv --curve force.svg",
                      "palpate touch case.vtkhdf --script hand.txt --json stats.json",
                      "palpate touch case.vtkhdf --instrument probe.stl --script slide --json stats.json"},
         .notes =
             "Scripts: 'press' goes in along the surface's normal, holds 0.5 s and leaves, over and over; "
             "'slide' presses once and slides 4 mm to either side; 'tremble' presses and trembles there as "
             "a hand does, 8 to 12 Hz; 'let-go' presses, lets go of the device, and takes hold again "
             "outside; 'random' pushes, slides and leaves, and turns an instrument; a file has rows 'x y z' "
             "(mm), one per millisecond, or 't x y z' (s, mm), either followed by a quaternion "
             "'qx qy qz qw' that turns the tool; with --column N it is a recording of one axis at 1 kHz, "
             "which moves along the surface's normal. 'grasp', of --instrument forceps, goes in over a rim, "
             "closes the "
             "jaws, draws it out and lets it go; a file of a forceps has rows 't x y z qx qy qz qw a', a the "
             "angle "
             "between the jaws in degrees. Without --device the hand is infinitely stiff: it is "
             "where the script says, whatever the force.\n"
             "Devices: " +
             device_sentences() +
             ". A device stands with the middle of its workspace where the hand starts, upright on the "
             "touched "
             "surface; for a path from a file its up is the patient's front. 'palpate doctor' says what a "
             "device lacks.\n"
             "Schemes: " +
             contact_method_sentences() +
             ".\n"
             "A recording has every tick of every tool, with its contacts, in a ring of the last "
             "--record-seconds (formats/recording/SPEC.md, for h5py); it has its name from the start and is "
             "kept however the run ends, where other outputs appear whole or not at all. A replay gives its "
             "forces again, bit for bit, or ends with exit code 4."});
    TouchOptions options;
    const TouchHandles given = declare(command, options);
    return command.run(argc, argv, [&](cli::Session& session) {
        options.seconds_given = given.seconds.given();
        if (options.tool.has_jaws() && !given.script.given()) options.script = devices::grasp_script;
        if (given.replay.given())
            cli::refuse_beside(command, "--replay",
                               std::array{given.asset, given.log, given.curve, given.replay},
                               "a recording says itself what the run was like");
        check(command, options.tool, options.scheme);
        check_large_deformation(options.hyperelastic, options.scheme);
        refuse_idle_options(command, options);
        return touch(options, session);
    });
}
