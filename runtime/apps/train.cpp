// SPDX-License-Identifier: Apache-2.0
// palpate train: the trainer's window beside the haptic loop.
#include <charconv>
#include <chrono>
#include <future>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <vector>

#include "formats/asset/hdf5/signature.hpp"
#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "formats/provenance/cautions.hpp"
#include "runtime/apps/exercises/save_exercise.hpp"
#include "runtime/apps/exercises/train_lesson.hpp"
#include "runtime/apps/first_sight.hpp"
#include "runtime/apps/options/large_option.hpp"
#include "runtime/apps/options/point_option.hpp"
#include "runtime/apps/options/tool_option.hpp"
#include "runtime/apps/playback/expert_ghost.hpp"
#include "runtime/apps/playback/train_playback.hpp"
#include "runtime/apps/run_keys.hpp"
#include "runtime/apps/start_recording.hpp"
#include "runtime/apps/tell_statuses.hpp"
#include "runtime/apps/train_run.hpp"
#include "runtime/devices/device_model.hpp"
#include "runtime/devices/jaws/jaws.hpp"
#include "runtime/devices/mounted_device.hpp"
#include "runtime/devices/simulation.hpp"
#include "runtime/session/clear_hold.hpp"
#include "runtime/session/device_list.hpp"
#include "runtime/session/hand_script.hpp"
#include "runtime/session/jaws/grasp_place.hpp"
#include "runtime/session/session.hpp"
#include "runtime/session/statistics_json.hpp"
#include "runtime/session/touch_target.hpp"
#include "runtime/texts/translated.hpp"
#include "runtime/training/lay_out.hpp"
#include "runtime/visual/train_window.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {
namespace {

using namespace devices;
using namespace haptics;
using namespace session;
using namespace visual;

using Clock = std::chrono::steady_clock;
using Eigen::Quaterniond;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

struct Options {
    std::filesystem::path asset, screenshot, record;
    std::vector<std::filesystem::path> trusted;
    LessonOptions lesson;
    PlaybackOptions playback;
    std::string size, script, second, body, target, scheme{usual_contact_method}, device, stream;
    double seconds = 0, record_seconds = 300;
    ToolOption tool;
    std::vector<std::string> hyperelastic;
};

// `for_pictures`: which are alike on every machine.
std::optional<WindowSize> size_of(const std::string& text, bool for_pictures) {
    if (text.empty()) return for_pictures ? std::optional(WindowSize{1280, 720}) : std::nullopt;
    int width = 0, height = 0;
    const char* end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, width);
    if (first.ec == std::errc{} && first.ptr != end && *first.ptr == 'x' &&
        std::from_chars(first.ptr + 1, end, height).ptr == end && width >= 320 && height >= 240 &&
        width <= 16384 && height <= 16384)
        return WindowSize{width, height};
    throw UsageError({"--size", text, "WIDTHxHEIGHT in pixels, 320x240 or more", "for example 1280x720"});
}

HandPath scripted_path(const Options& options, const TouchPoint& place, double tool_radius) {
    constexpr std::uint64_t seed = 1;  // of the scripts 'random' and 'tremble'
    const ScriptSettings settings{.tool_radius = tool_radius,
                                  .seconds = options.seconds > 0 ? options.seconds : 3600};
    return is_made_to_measure(options.script) ? made_to_measure_path(options.script, place, settings, seed)
                                              : recorded_path(options.script);
}

HandPath grasp_or_recorded(const Options& options, const GraspPlace& place) {
    if (options.script != grasp_script) return recorded_path(options.script, true);
    return grasp_path(place.grasp, options.tool.jaws,
                      {.seconds = options.seconds > 0 ? options.seconds : 3600});
}

// A rim as a place that is touched from where the forceps comes.
TouchTarget target_of(const GraspPlace& place) {
    TouchTarget target{.body = place.body, .place = {}};
    target.place.normal = place.grasp.out();
    target.place.tangent = place.grasp.orientation * Eigen::Vector3d::UnitX();
    target.place.point = place.grasp.rim();
    return target;
}

// From the side, so that both jaws are seen and which way they go; from whichever less stands before, and
// wide enough for the way there.
Sight sight_of(const Case& patient_case, const HapticModel& model, const Grasp& grasp,
               const JawSettings& jaws) {
    constexpr double jaws_seen = 5, aside = 1.5;  // lengths of a jaw; to the side for each one out
    const Eigen::Vector3d beside = aside * (grasp.orientation * Eigen::Vector3d::UnitY());
    const auto look = [&](const Eigen::Vector3d& from) {
        return first_sight(patient_case, model, grasp.rim(), from.normalized());
    };
    Sight sight = look(grasp.out() + beside);
    if (sight.blocked) sight = look(grasp.out() - beside);
    if (!sight.inside) sight.field = std::max(sight.field, jaws_seen * jaws.jaw_length);
    return sight;
}

// How mouse and keyboard hold a tool that turns first, R_PT; nothing where none do.
std::optional<Quaterniond> first_orientation(const Options& options, const DeviceKind& device,
                                             const Case& patient_case, const TouchPoint& place,
                                             const std::optional<GraspPlace>& grasp,
                                             const WindowSettings& window) {
    if (!device.simulated || !options.script.empty() || options.tool.tool.empty()) return std::nullopt;
    if (grasp) return grasp->grasp.orientation;
    return clear_hold(patient_case, window.surfaces, window.start, place.normal,
                      window.sight.inside ? std::optional(window.sight.eye()) : std::nullopt);
}

// `start`: where a hand that no script moves begins, p_P, mm; `orientation`: of first_orientation(); `R_PD`:
// how a device that a person's hand holds is turned.
DeviceRequest request_of(const Options& options, const DeviceKind& device, const HapticModel& model,
                         const TouchPoint& place, const std::optional<GraspPlace>& grasp,
                         const Vector3d& start, const std::optional<Quaterniond>& orientation,
                         const Eigen::Matrix3d& R_PD) {
    DeviceRequest request{.tools = {}, .limits = limits_asked_by(model.settings())};
    if (options.tool.has_jaws()) request.limits = limits_of_both(request.limits);
    const std::array<double, 3> shaft = array_of(place.normal);
    const Quaterniond held = orientation.value_or(Quaterniond(0, 0, 0, 0));
    if (options.tool.has_jaws()) {
        request.tools.push_back({.place = DevicePlace{start, device.simulated ? upright(place.normal) : R_PD},
                                 .shaft = shaft,
                                 .orientation = held});
        if (device.simulated && !options.script.empty())
            request.tools.back() = scripted_tool(grasp_or_recorded(options, *grasp), place.normal, shaft);
        return request;
    }
    if (!device.simulated)  // several at one place, so that all reach what one does
        request.tools.assign(model.tool_count(), HeldTool{.place = DevicePlace{start, R_PD}});
    else if (options.script.empty())
        request.tools.push_back(
            {.place = DevicePlace{start, upright(place.normal)}, .shaft = shaft, .orientation = held});
    else
        request.tools.push_back(scripted_tool(scripted_path(options, place, model.contact_radius()),
                                              is_made_to_measure(options.script) ? place.normal : anterior,
                                              shaft));
    if (!options.second.empty())
        request.tools.push_back(scripted_tool(recorded_path(options.second), anterior, shaft));
    return request;
}

// Where the tool starts: where it is told to, in an exercise where something is to be felt, otherwise as
// 'touch'.
TouchTarget start_of(const Options& options, const Session& run) {
    constexpr std::uint64_t seed = 1;
    if (!options.target.empty())
        return choose_touch_target(run.patient_case(), run.model(), options.body,
                                   point_of("--target", options.target));
    if (!options.script.empty() && options.lesson.exercise.empty())
        return choose_touch_target(run.patient_case(), run.model(), options.body, std::nullopt);
    return training::choose_start(run.patient_case(), run.model(), options.body, seed);
}

Json train(const Options& options, cli::Session& session) {
    const auto asked = Clock::now();
    const auto size = size_of(options.size, !options.screenshot.empty());
    if (!options.record.empty()) cli::seekable_target(options.record);
    std::optional<cli::StagedFile> picture;
    if (!options.screenshot.empty()) picture.emplace(options.screenshot, session.force);

    session.progress.step("reading the case", 0);
    const DeviceChoice device = choose_device(options.device, "--device");
    if (!device.kind.simulated && !options.script.empty())
        throw UsageError({"--script", "with --device " + options.device, "a simulated device", ""});
    if (!device.kind.simulated && !options.second.empty())
        throw UsageError({"--second", "with --device " + options.device, "a simulated device", ""});
    find_contact_method(options.scheme, "--scheme");
    check_hand(options.tool, options.script, device, options.second);
    const std::size_t tools = options.second.empty() && !options.tool.has_jaws() ? device.tool_count : 2;
    const auto trusted = asset::read_public_keys(options.trusted);
    const auto tool = tool_body(options.tool);
    // Reading and opening a window take about as long, and two processors do both at once.
    auto reading = std::async(std::launch::async, [&] {
        return std::make_unique<Session>(SessionRequest{.asset = options.asset,
                                                        .method = options.scheme,
                                                        .tool_count = tools,
                                                        .trusted_keys = trusted,
                                                        .tool = tool,
                                                        .jaws = jaws_of(options.tool),
                                                        .hyperelastic = options.hyperelastic,
                                                        .stream = options.stream},
                                         [](const std::string& sentence) { spdlog::warn("{}", sentence); });
    });
    auto opened = open_window(size, texts::translated("reading {}", options.asset.filename().string()));
    const std::unique_ptr<Session> read = reading.get();
    Session& run = *read;
    std::optional<ExpertGhost> ghost;
    if (!options.playback.ghost.empty()) ghost.emplace(options.playback.ghost, options.asset);
    const Case& patient_case = run.patient_case();
    tell_unfelt(patient_case, options.scheme);
    std::optional<GraspPlace> grasp;
    if (run.jaws())
        grasp = choose_grasp_place(patient_case, run.model(), *run.jaws(), options.body,
                                   point_of("--target", options.target));
    const TouchTarget target = grasp ? target_of(*grasp) : start_of(options, run);
    const TouchPoint& place = target.place;
    const Eigen::Vector3d start =
        grasp ? grasp->grasp.outside() : start_outside(place, tip_reach(patient_case));
    WindowSettings window_settings{
        .start = start,
        .sight = grasp ? sight_of(patient_case, run.model(), grasp->grasp, *run.jaws())
                       : first_sight(patient_case, run.model(), place.point, place.normal),
        .cautions = provenance::cautions_in(patient_case.provenance),
        .surfaces = surfaces_of(run.model())};
    window_settings.orientation =
        first_orientation(options, device.kind, patient_case, place, grasp, window_settings);
    if (grasp) window_settings.jaw_length = run.jaws()->jaw_length;
    cli::end_softly_on_interrupt();
    run.hold(device.open(request_of(options, device.kind, run.model(), place, grasp, start,
                                    window_settings.orientation, window_settings.sight.axes())),
             grasp ? grasp->grasp.orientation : Eigen::Quaterniond::Identity());
    if (!options.device.empty()) tell_torque(run.model(), run.device_name());
    tell_too_weak(patient_case, run.device_name());
    if (const DeviceModel* model = model_of_device(run.device_name()))
        window_settings.rendered = model->coulomb_friction;

    std::vector<LaidOut> exercises =
        lay_out_exercises(options.lesson, run, target,
                          {.place = window_settings.sight.eye(), .cuts = window_settings.sight.blocked});
    // What an exercise leads along is looked at closely too.
    for (const LaidOut& laid_out : exercises)
        if (laid_out.exercise.task == training::Task::guide)
            window_settings.sight.close_up.insert(window_settings.sight.close_up.end(),
                                                  laid_out.exercise.places.rbegin(),
                                                  laid_out.exercise.places.rend());
    TrainLesson lesson(options.lesson, exercises, run,
                       {.case_name = patient_case.name,
                        .trainee = options.lesson.trainee,
                        .cautions = window_settings.cautions},
                       !options.script.empty());

    session.progress.step("filling the window", 0.5);
    TrainWindow window(std::move(opened), patient_case, window_settings);
    session.progress.finish();
    VisualFrame frame;
    for (const DeformableBody& body : patient_case.deformable_bodies)
        frame.displacements.emplace_back(body.boundary.nodes.size());
    frame.device_position = frame.tool_position = start;
    frame.device = run.device_name();
    window.show(frame);  // the first frame compiles shaders
    const double first_frame_s = std::chrono::duration<double>(Clock::now() - asked).count();

    if (!options.record.empty()) start_recording(run, options.record, options.record_seconds, session);
    RunKeys run_keys(run, options.record_seconds, session);
    const auto [frame_ns, late_ns, seconds, felt] =
        run_in_window({.session = run,
                       .window = window,
                       .lesson = lesson,
                       .keys = run_keys,
                       .ghost = ghost ? &*ghost : nullptr,
                       .shows_shaft = !device.kind.simulated || grasp,
                       .seconds = options.seconds},
                      frame);
    if (cli::interrupt_asked()) {
        spdlog::warn("interrupted: the force has gone to zero, recording and attempts alone are kept");
        throw cli::Interrupted();
    }
    if (window.lost()) spdlog::warn("the force has gone to zero, recording and attempts alone are kept");
    window.require_display();
    if (picture) {
        window.save_picture(picture->path());
        picture->commit();
    }

    const ServoStatistics statistics = run.statistics();
    for (const realtime::SetupResult& setup : statistics.setup)
        if (!setup.ok) spdlog::warn("{}", setup.message);
    tell_statuses(run.statuses());
    Json result{{"case", patient_case.name},
                {"cautions", window_settings.cautions},
                {"device", run.device_name()},
                {"first_frame_s", first_frame_s},
                {"frames", frame_ns.count()},
                {"frames_per_second", static_cast<double>(frame_ns.count()) / seconds},
                {"frame_ms", percentiles_json(frame_ns, 1e6)},
                {"shown_late_ms", percentiles_json(late_ns, 1e6)},
                {"detail",
                 {{"level", window.detail().level},
                  {"levels", window.detail().levels},
                  {"changes", window.detail().changes}}},
                {"ticks", statistics.ticks},
                {"overruns", statistics.overruns},
                {"tick_us", percentiles_json(statistics.tick_ns, 1e3)},
                {"wake_latency_us", percentiles_json(statistics.wake_latency_ns, 1e3)},
                {"force_peak_n", felt.force_peak},
                {"penetration", {{"device_mm", felt.depth_peak}}},
                {"device_travel_mm", felt.travel},
                {"statuses", run.statuses().by_name()},
                {"faults", run.faults_json()},
                {"attempts", lesson.attempts()},
                {"recorded_by_key", run_keys.recordings()},
                {"scheme", run.model().method().name},
                {"large_deformation", run.deforming_far()}};
    if (const auto rows = run.recorded_rows())
        result["recording"] = {{"rows", *rows}, {"lost_rows", statistics.lost_records}};
    return result;
}

}  // namespace
}  // namespace palpate::apps

int main(int argc, char** argv) {
    using namespace palpate;
    using namespace palpate::apps;
    texts::follow_the_desktop();
    cli::Command command(
        {.name = "train",
         .summary = "Opens the trainer's window on an asset",
         .examples = {"palpate train case.vtkhdf",
                      "palpate train case.vtkhdf --script press --seconds 10 --screenshot press.png",
                      "palpate train case.vtkhdf --play run.h5 --video run.ogv"},
         .notes =
             "The mouse holds the tool: it hovers over the surface under the pointer, presses while the left "
             "button is held and slides where it is dragged; the wheel or W and S then change how deep it "
             "presses. In an exercise it presses as hard as that asks. "
             "Without a button W, S and the arrow keys step. Drag with the right button to turn the "
             "view, with the middle one or Shift and left to shift it, with Ctrl and left to roll it; the "
             "wheel, + and - zoom, C cuts the bodies open, B hides the rigid ones, I shows and hides "
             "how the case was made, T shows what they enclose, G how stiff they are, V looks from the "
             "tool's tip, first in the "
             "whole window, where drag and wheel lead that, then in a corner of it, P saves a "
             "picture in this folder, O records every tick there from then on or stops, A lets the force be "
             "heard, F takes the next contact scheme, U takes a change of "
             "the view back, R goes back to the start, H shows what the mouse does, Q or Escape closes; the "
             "buttons below do the same. A forceps is carried by a drag of the left button, W and S take it "
             "along its "
             "shaft, J closes its jaws and opens them. Shift with the arrow keys, or with a drag of "
             "the right button, turns an instrument, rod or forceps about its tip, with W and S about its "
             "shaft. "
             "The "
             "window needs an X display; on a machine "
             "without one use 'xvfb-run'.\n"
             "With --device " +
             device_usages([](const DeviceKind& kind) { return !kind.simulated; }, false) +
             ", as for 'touch', a person's hand moves the tool. A device that renders force stands before "
             "the "
             "picture: its right, up and towards the user are those of the first view. With " +
             device_usages([](const DeviceKind& kind) { return kind.simulated; }, false) +
             " mouse and keyboard, or a script, hold a simulated device that gives way."});
    Options options;
    const auto asset = command.input("asset", options.asset, "the case (.vtkhdf)").required();
    const auto size = command.option("--size", options.size,
                                     "WIDTHxHEIGHT of the window; if not given, two thirds of a large "
                                     "display, 1280x720 or less of others and for pictures and films",
                                     "pixels");
    const auto seconds =
        command.option("--seconds", options.seconds, "close after this time; 0: when told to", "s");
    command.input(
        "--trusted", options.trusted,
        "public keys (Ed25519, PEM): load the asset only if one of them has signed it; repeat for more");
    command.option("--script", options.script,
                   "what the hand does instead of mouse and keyboard: press, slide, tremble, let-go, random, "
                   "of a forceps "
                   "grasp, or a file as for 'touch'");
    command.option("--second", options.second,
                   "what a second tool on the same bodies does: a file as for --script");
    command.option("--device", options.device, device_usages([](const DeviceKind&) { return true; }, true));
    command.option("--stream", options.stream,
                   "PORT or ADDRESS:PORT at which 3D Slicer and others see the session over OpenIGTLink");
    command.option("--scheme", options.scheme, "how contact is found: " + contact_method_names());
    declare(command, options.tool);
    declare_large_deformation(command, options.hyperelastic);
    command.input("--exercises", options.lesson.exercises,
                  "exercises of your own (.toml); ASSET-exercises.toml beside the asset, and those that "
                  "every patient offers, if not given");
    command.option("--exercise", options.lesson.exercise, "begin with this one instead of the start page");
    command.option("--trainee", options.lesson.trainee, "a pseudonym, under which attempts are kept");
    command.option("--attempts", options.lesson.attempts,
                   "folder in which attempts are kept; ~/.local/share/palpate/attempts if not given");
    command.option("--target", options.target, "x,y,z: start at the surface point nearest to it", "mm");
    command.option("--body", options.body, "which body to start at; the first deformable one if not given");
    command.output(
        "--record", options.record,
        "every tick, for --play and 'palpate touch --replay' (.h5); kept however the trainer ends");
    command.option("--record-seconds", options.record_seconds,
                   "how much of the end a recording holds: 51 MB a minute", "s");
    const auto screenshot =
        command.output("--screenshot", options.screenshot, "picture of the window at the end (.png)");
    const auto check_playback =
        declare_playback(command, options.playback, {asset, size, seconds, screenshot});
    return command.run(argc, argv, [&](cli::Session& session) {
        check_playback();
        check(command, options.tool, options.scheme);
        check_large_deformation(options.hyperelastic, options.scheme);
        options.lesson.usual = usual_exercise_file(options.asset);
        if (options.playback.play.empty()) return train(options, session);
        return play_recording(
            options.playback,
            {.asset = options.asset,
             .trusted_keys = asset::read_public_keys(options.trusted),
             .size = size_of(options.size, !(options.screenshot.empty() && options.playback.video.empty() &&
                                             options.playback.pictures.empty())),
             .seconds = options.seconds,
             .screenshot = options.screenshot},
            session);
    });
}
