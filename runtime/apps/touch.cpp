// SPDX-License-Identifier: Apache-2.0
#include <chrono>
#include <fstream>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <sstream>
#include <thread>
#include <vector>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"
#include "runtime/apps/hand_script.hpp"
#include "runtime/apps/run_record.hpp"
#include "runtime/apps/simulation.hpp"
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
    std::string script = "press", body, target, second, scheme = "continuous", device, shaft;
    double seconds = 10, depth = 3, speed = 20;
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
             {"friction_n", Json::array({contact.friction[0], contact.friction[1], contact.friction[2]})},
             {"part", contact.part},
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
void run_in_real_time(ServoLoop& loop, std::vector<RunRecord>& records, double seconds) {
    TickResult result{};
    const auto add = [&] { records[static_cast<std::size_t>(result.tool)].add(result); };
    while (records.back().curve().empty() || records.back().curve().back().time < seconds) {
        if (loop.ring().pop(result))
            add();
        else
            std::this_thread::sleep_for(std::chrono::milliseconds(2));
    }
    loop.stop();
    while (loop.ring().pop(result)) add();
}

Json touch(const Options& options, cli::Session& session) {
    std::optional<cli::StagedFile> log_file, curve_file;
    std::ofstream log;
    if (!options.log.empty()) {
        log.open(log_file.emplace(options.log, session.force).path());
        write_log_head(log);
    }
    if (!options.curve.empty()) curve_file.emplace(options.curve, session.force);

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
    std::vector<RunRecord> records;
    for (const auto& device : devices) {
        held.push_back(device.get());
        records.emplace_back(model, options.log.empty() ? nullptr : &log);
    }
    ServoLoop loop(model, held);
    const RunRecord& record = records.front();
    double ready_s = 0;
    if (options.virtual_clock) {
        ready_s = process_age();
        loop.run_virtual(static_cast<std::int64_t>(1000 * plan.seconds), [&](const TickResult& result) {
            records[static_cast<std::size_t>(result.tool)].add(result);
        });
    } else {
        loop.start();
        ready_s = process_age();
        run_in_real_time(loop, records, plan.seconds);
    }

    // A script's file name may name a patient.
    const std::string script = is_made_to_measure(options.script) ? options.script : "file";
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
                {"scheme", options.scheme},
                {"device", devices.front()->name()},
                {"coupling_stiffness_n_per_mm", model.coupling()},
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
    if (records.size() > 1)
        result["second"] = {
            {"force_peak_n", records[1].peak_force()},
            {"force_step_max_n", records[1].largest_force_step()},
            {"penetration", {{"device_mm", records[1].device_depth()}, {"tool_mm", records[1].tool_depth()}}},
            {"statuses", records[1].statuses()},
            {"peak", peak_json(records[1].peak(), patient_case, model)}};
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
    command.flag("--virtual-clock", options.virtual_clock,
                 "tick as fast as possible; forces do not depend on the machine");
    return command.run(argc, argv, [&](cli::Session& session) {
        options.seconds_given = seconds->count() > 0;
        return touch(options, session);
    });
}
