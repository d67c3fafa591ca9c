// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <fstream>
#include <optional>
#include <spdlog/spdlog.h>
#include <sstream>
#include <thread>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"
#include "runtime/apps/hand_script.hpp"
#include "runtime/apps/run_record.hpp"
#include "runtime/apps/statistics_json.hpp"
#include "runtime/apps/touch_target.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "runtime/realtime/process_age.hpp"
#include "tools/cli/command.hpp"

namespace palpate {
namespace {

using Json = nlohmann::ordered_json;

struct Options {
    std::filesystem::path asset, log, curve;
    std::string script = "press", body, target;
    double seconds = 10, depth = 3, speed = 20;
    bool seconds_given = false, virtual_clock = false;
};

// What the hand does, and where if that was chosen here.
struct Plan {
    HandPath path;
    std::optional<TouchTarget> target;
    double seconds;
};

std::optional<Eigen::Vector3d> point_of(std::string text) {
    if (text.empty()) return std::nullopt;
    std::istringstream stream(text);
    Eigen::Vector3d p;
    char comma = ',', other_comma = ',';
    stream >> p[0] >> comma >> p[1] >> other_comma >> p[2];
    if (!stream || comma != ',' || other_comma != ',' || stream.peek() != EOF)
        throw UsageError({"--target", text, "x,y,z in mm", ""});
    return p;
}

// At least one tick, so that there is something to report.
void require_positive(double seconds) {
    if (!(seconds >= 1e-3)) throw UsageError({"--seconds", std::to_string(seconds), "0.001 or more", ""});
}

Plan plan_of(const Options& options, const Case& patient_case, const HapticModel& model) {
    if (!is_made_to_measure(options.script)) {
        HandPath path = recorded_path(options.script);
        const double seconds = options.seconds_given ? options.seconds : path.duration();
        require_positive(seconds);
        return {std::move(path), std::nullopt, seconds};
    }
    require_positive(options.seconds);
    const TouchTarget target =
        choose_touch_target(patient_case, model, options.body, point_of(options.target));
    const ScriptSettings settings{.tool_radius = model.settings().tool_radius,
                                  .depth = options.depth,
                                  .speed = options.speed,
                                  .seconds = options.seconds};
    return {made_to_measure_path(options.script, target.place, settings), target, options.seconds};
}

Json numbers(std::span<const double, 3> v) {
    return Json::array({v[0], v[1], v[2]});
}

Json target_json(const TouchTarget& target, const HapticModel& model) {
    return {{"body", model.body_name(target.body)},
            {"triangle", target.triangle},
            {"point_mm", numbers(std::span<const double, 3>(target.place.point.data(), 3))},
            {"normal", numbers(std::span<const double, 3>(target.place.normal.data(), 3))},
            {"clearance_mm", target.place.clearance}};
}

// The tick of the largest force, with all that is needed to compute it again from the stiffness matrix.
Json peak_json(const TickResult& peak, const Case& patient_case, const HapticModel& model) {
    Json contacts = Json::array();
    for (const Contact& contact : peak.active_contacts()) {
        const auto body = static_cast<std::size_t>(contact.body);
        const bool deformable = body >= model.rigid_count();
        Json nodes = Json::array(), weights = Json::array();
        for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i) {
            const auto vertex = static_cast<std::size_t>(contact.vertices[i]);
            const auto* soft =
                deformable ? &patient_case.deformable_bodies[body - model.rigid_count()] : nullptr;
            nodes.push_back(soft ? soft->boundary.nodes[vertex] : contact.vertices[i]);
            weights.push_back(contact.weights[i]);
        }
        contacts.push_back(
            {{"body", model.body_name(body)},
             {"nodes", nodes},
             {"weights", weights},
             {"normal", Json::array({contact.normal[0], contact.normal[1], contact.normal[2]})},
             {"gap_mm", contact.gap},
             {"force_n", contact.force},
             {"series_compliance_mm_per_n", contact.series_compliance}});
    }
    return {{"t_s", peak.time},
            {"device_mm", numbers(peak.device_position)},
            {"force_n", numbers(peak.force)},
            {"depth_mm", peak.depth},
            {"coupling_stiffness_n_per_mm", model.coupling()},
            {"contacts", contacts}};
}

// Ticks in the haptic thread while this one writes the log.
void run_in_real_time(ServoLoop& loop, RunRecord& record, double seconds) {
    TickResult result{};
    while (record.curve().empty() || record.curve().back().time < seconds) {
        if (loop.ring().pop(result))
            record.add(result);
        else
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    loop.stop();
    while (loop.ring().pop(result)) record.add(result);
}

Json touch(const Options& options, cli::Session& session) {
    std::optional<cli::StagedFile> log_file, curve_file;
    std::ofstream log;
    if (!options.log.empty()) log.open(log_file.emplace(options.log, session.force).path());
    if (!options.curve.empty()) curve_file.emplace(options.curve, session.force);

    const Case patient_case = read_asset(options.asset);
    HapticModel model(patient_case);
    const Plan plan = plan_of(options, patient_case, model);
    SimulatedDevice device(plan.path, {.max_force = model.settings().max_force,
                                       .max_stiffness = model.settings().coupling_stiffness});
    ServoLoop loop(model, device);
    RunRecord record(model, options.log.empty() ? nullptr : &log);
    double ready_s = 0;
    if (options.virtual_clock) {
        ready_s = process_age();
        loop.run_virtual(static_cast<std::int64_t>(1000 * plan.seconds),
                         [&](const TickResult& result) { record.add(result); });
    } else {
        loop.start();
        ready_s = process_age();
        run_in_real_time(loop, record, plan.seconds);
    }

    // A script's file name may name a patient.
    const std::string script = plan.target ? options.script : "file";
    if (log_file) {
        log.close();
        if (!log) throw SystemFailure({options.log.string(), "could not be written", "", "check free space"});
    }
    if (curve_file) {
        curve_file->write_text(force_curve_svg(record.curve(), patient_case.name + ": " + script));
        curve_file->commit();
    }
    if (log_file) log_file->commit();

    const ServoStatistics statistics = loop.statistics();
    for (const SetupResult& setup : statistics.setup)
        if (!setup.ok) spdlog::warn("{}", setup.message);
    Json result{{"case", patient_case.name},
                {"script", script},
                {"clock", options.virtual_clock ? "virtual" : "real"},
                {"ready_s", ready_s},
                {"ticks", statistics.ticks},
                {"overruns", statistics.overruns},
                {"lost_log_records", options.virtual_clock ? 0 : statistics.lost_records},
                {"tick_us", percentiles_json(statistics.tick_ns, 1e3)},
                {"wake_latency_us", percentiles_json(statistics.wake_latency_ns, 1e3)},
                {"force_peak_n", record.peak_force()},
                {"force_step_max_n", record.largest_force_step()},
                {"penetration", {{"device_mm", record.device_depth()}, {"tool_mm", record.tool_depth()}}},
                {"statuses", record.statuses()}};
    if (plan.target) result["target"] = target_json(*plan.target, model);
    result["peak"] = peak_json(record.peak(), patient_case, model);
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
             "Scripts: 'press' goes in along the surface's normal, holds 0.5 s and lets go, over and over; "
             "'slide' presses once and slides 4 mm to either side; a file has rows 'x y z' (mm), one per "
             "millisecond, or 't x y z' (s, mm). The hand is infinitely stiff: it is where the script says, "
             "whatever the force."});
    Options options;
    command.input("asset", options.asset, "the case (.vtkhdf)")->required();
    command.option("--script", options.script, "what the hand does: press, slide or a file");
    const CLI::Option* seconds =
        command.option("--seconds", options.seconds, "how long; of a file, all unless this is given", "s");
    command.option("--depth", options.depth, "how deep the tool's surface goes below the rest surface", "mm");
    command.option("--speed", options.speed, "of press and slide", "mm/s");
    command.option("--body", options.body, "which body; the first deformable one if not given");
    command.option(
        "--target", options.target,
        "x,y,z: touch the surface point nearest to it; the most compliant place in reach if not given", "mm");
    command.output("--log", options.log, "one row per tick (.csv)");
    command.output("--curve", options.curve, "force and depth over time (.svg)");
    command.flag("--virtual-clock", options.virtual_clock,
                 "tick as fast as possible; forces do not depend on the machine");
    return command.run(argc, argv, [&](cli::Session& session) {
        options.seconds_given = seconds->count() > 0;
        return touch(options, session);
    });
}
