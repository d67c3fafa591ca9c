// SPDX-License-Identifier: Apache-2.0
// palpate train: the trainer's window beside the haptic loop.
#include <charconv>
#include <chrono>
#include <functional>
#include <memory>
#include <optional>
#include <spdlog/spdlog.h>
#include <thread>

#include "formats/asset/asset.hpp"
#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "runtime/apps/hand_script.hpp"
#include "runtime/apps/live_stream.hpp"
#include "runtime/apps/physical_devices.hpp"
#include "runtime/apps/run_watch.hpp"
#include "runtime/apps/servo_pulse.hpp"
#include "runtime/apps/simulation.hpp"
#include "runtime/apps/start_recording.hpp"
#include "runtime/apps/statistics_json.hpp"
#include "runtime/apps/touch_target.hpp"
#include "runtime/devices/guided_device.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "runtime/visual/train_window.hpp"
#include "tools/cli/command.hpp"

namespace palpate {
namespace {

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

struct Options {
    std::filesystem::path asset, screenshot, record;
    std::string size = "1280x720", script, body, scheme = "continuous", device, stream;
    double seconds = 0, record_seconds = 300;
};

std::pair<int, int> size_of(const std::string& text) {
    int width = 0, height = 0;
    const char* end = text.data() + text.size();
    const auto first = std::from_chars(text.data(), end, width);
    if (first.ec == std::errc{} && first.ptr != end && *first.ptr == 'x' &&
        std::from_chars(first.ptr + 1, end, height).ptr == end && width >= 320 && height >= 240 &&
        width <= 16384 && height <= 16384)
        return {width, height};
    throw UsageError({"--size", text, "WIDTHxHEIGHT in pixels, 320x240 or more", "for example 1280x720"});
}

HandPath scripted_path(const Options& options, const TouchPoint& place, double tool_radius) {
    constexpr std::uint64_t seed = 1;  // of the scripts 'random' and 'tremble'
    const ScriptSettings settings{.tool_radius = tool_radius,
                                  .seconds = options.seconds > 0 ? options.seconds : 3600};
    return is_made_to_measure(options.script) ? made_to_measure_path(options.script, place, settings, seed)
                                              : recorded_path(options.script);
}

// What the tool is held by; where mouse and keyboard move it, `guide` takes the places (p_P, mm) they
// mean.
struct Held {
    std::unique_ptr<Device> device = nullptr;
    std::function<void(const Eigen::Vector3d&)> guide = [](const Eigen::Vector3d&) {};
    std::unique_ptr<PhysicalDevices> physical = nullptr;

    std::vector<Device*> devices() const {
        return physical ? physical->devices() : std::vector{device.get()};
    }
    Servo* servo() const { return physical ? physical->servo() : nullptr; }
};

Held device_of(const Options& options, const HapticModel& model, const TouchPoint& place,
               const Eigen::Vector3d& start) {
    const DeviceLimits limits{.max_force = model.settings().max_force,
                              .max_stiffness = model.settings().coupling_stiffness};
    const std::array<double, 3> shaft = array_of(place.normal);
    const DeviceModel* simulated = options.device.empty() ? nullptr : &find_device_model(options.device);
    if (!options.script.empty()) {
        // The published schemes know the tip's centre alone.
        const bool has_radius = model.scheme() == ContactScheme::continuous;
        HandPath path = scripted_path(options, place, has_radius ? model.settings().tool_radius : 0);
        const Eigen::Vector3d up = is_made_to_measure(options.script) ? place.normal : anterior;
        if (simulated) return {.device = simulate(*simulated, path, up, shaft)};
        return {.device = std::make_unique<SimulatedDevice>(std::move(path), limits, shaft)};
    }
    if (simulated) {
        const Eigen::Isometry3d X_PD = placed_at(*simulated, start, place.normal), X_DP = X_PD.inverse();
        const auto hand = std::make_shared<GuidedHand>(array_of(X_DP * start));
        return {simulate(*simulated, hand, X_PD, shaft),
                [hand, X_DP](const Eigen::Vector3d& p) { hand->set_target(array_of(X_DP * p)); }};
    }
    auto guided = std::make_unique<GuidedDevice>(array_of(start), limits, GuidedHand::usual_speed, shaft);
    GuidedDevice& device = *guided;
    return {std::move(guided), [&device](const Eigen::Vector3d& p) { device.set_target(array_of(p)); }};
}

// Everything felt since the start, from the ticks that the loop left in its ring.
struct Felt {
    double force_peak = 0;  // N
    double depth_peak = 0;  // mm
    double travel = 0;      // mm, of the device
    std::optional<Eigen::Vector3d> last_position;
    std::optional<RunRecorder> recorder;

    void take(SpscRing<TickResult>& ring, RunWatch& watch) {
        for (TickResult tick; ring.pop(tick);) {
            watch.add(tick);
            if (recorder) recorder->add(tick);
            const Eigen::Vector3d position = Eigen::Map<const Eigen::Vector3d>(tick.device_position.data());
            force_peak = std::max(force_peak, Eigen::Map<const Eigen::Vector3d>(tick.force.data()).norm());
            depth_peak = std::max(depth_peak, tick.depth);
            if (last_position) travel += (position - *last_position).norm();
            last_position = position;
        }
        if (recorder) recorder->set_lost(ring.dropped());
    }
};

// The tick rate over the last half second or more.
class TickRate {
  public:
    double update(std::int64_t tick) {
        const auto now = Clock::now();
        const double seconds = std::chrono::duration<double>(now - since_).count();
        if (seconds > 0.5) {
            rate_ = static_cast<double>(tick - tick_) / seconds;
            since_ = now;
            tick_ = tick;
        }
        return rate_;
    }

  private:
    Clock::time_point since_ = Clock::now();
    std::int64_t tick_ = 0;
    double rate_ = 0;
};

void fill_frame(VisualFrame& frame, const TickResult& tick, const HapticModel& model) {
    frame.device_position = Eigen::Map<const Eigen::Vector3d>(tick.device_position.data());
    frame.tool_position = Eigen::Map<const Eigen::Vector3d>(tick.tool_position.data());
    frame.force = Eigen::Map<const Eigen::Vector3d>(tick.force.data());
    frame.depth = tick.depth;
    frame.overruns = tick.overruns;
    for (std::size_t i = 0; i < frame.displacements.size(); ++i)
        model.surface_displacement(model.rigid_count() + i, tick, frame.displacements[i]);
}

Json train(const Options& options, cli::Session& session) {
    constexpr auto shortest_frame = std::chrono::nanoseconds(1'000'000'000 / 60);
    const auto [width, height] = size_of(options.size);
    std::optional<cli::StagedFile> picture;
    if (!options.screenshot.empty()) picture.emplace(options.screenshot, session.force);

    session.progress.step("reading the case", 0);
    const Case patient_case = load_asset(options.asset);
    const std::optional<PhysicalDevice> physical = parse_physical_device(options.device);
    if (physical && physical->tool_count() > 1)
        throw UsageError({"--device", options.device, "one device",
                          "the window shows one tool; 'palpate touch' takes several"});
    if (physical && !options.script.empty())
        throw UsageError({"--script", "with --device " + options.device, "a simulated device", ""});
    HapticModel model(patient_case, find_contact_scheme(options.scheme), 1);
    const TouchPoint place = choose_touch_target(patient_case, model, options.body, std::nullopt).place;
    const Eigen::Vector3d start = start_outside(place, model.settings().tool_radius);
    WindowSettings window_settings{.width = width, .height = height, .start = start};
    window_settings.sight = choose_sight(patient_case, place.point, place.normal);

    cli::end_softly_on_interrupt();
    const Held held = physical ? Held{.physical = std::make_unique<PhysicalDevices>(
                                          *physical, start, window_settings.sight.axes())}
                               : device_of(options, model, place, start);
    const std::vector<Device*> devices = held.devices();

    session.progress.step("opening the window", 0.5);
    TrainWindow window(patient_case, window_settings);
    session.progress.finish();

    VisualFrame frame;
    for (const DeformableBody& body : patient_case.deformable_bodies)
        frame.displacements.emplace_back(body.boundary.nodes.size());
    frame.device_position = frame.tool_position = start;
    window.show(frame);  // the first frame compiles shaders

    ServoLoop loop(model, devices, held.servo());
    RunWatch watch(options.asset, loop, [](const std::string& sentence) { spdlog::warn("{}", sentence); });
    std::optional<LiveStream> stream;
    if (!options.stream.empty()) stream.emplace(options.stream, patient_case, 1);
    Felt felt;
    if (!options.record.empty())
        felt.recorder.emplace(start_recording(
            options.record,
            recording_head(options.asset, patient_case, model, devices, "real", cli::version()),
            options.record_seconds, session));
    TickRate rate;
    ServoPulse pulse;
    Histogram frame_ns;
    loop.start();
    const auto began = Clock::now();
    auto frame_began = began;
    const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
    while (!window.closed() && !cli::interrupt_asked() &&
           (options.seconds <= 0 || elapsed() < options.seconds)) {
        const TickResult& tick = loop.latest().read();
        pulse.see(tick.tick);
        fill_frame(frame, tick, model);
        frame.faults = watch.recent(tick.time);
        frame.tick_rate_hz = rate.update(tick.tick);
        window.show(frame);
        loop.visual_beat();
        held.guide(window.hand());
        felt.take(loop.ring(), watch);
        if (stream) stream->show(tick);
        std::this_thread::sleep_until(frame_began + shortest_frame);
        const auto now = Clock::now();
        frame_ns.record(static_cast<std::uint64_t>(std::chrono::nanoseconds(now - frame_began).count()));
        frame_began = now;
    }
    const double seconds = elapsed();
    loop.stop();
    felt.take(loop.ring(), watch);
    if (cli::interrupt_asked()) {
        spdlog::warn("interrupted: the force has gone to zero, only a recording is kept");
        throw cli::Interrupted();
    }
    if (picture) {
        window.save_picture(picture->path());
        picture->commit();
    }

    const ServoStatistics statistics = loop.statistics();
    for (const SetupResult& setup : statistics.setup)
        if (!setup.ok) spdlog::warn("{}", setup.message);
    Json result{{"case", patient_case.name},
                {"device", devices.front()->name()},
                {"frames", frame_ns.count()},
                {"frames_per_second", static_cast<double>(frame_ns.count()) / seconds},
                {"frame_ms", percentiles_json(frame_ns, 1e6)},
                {"ticks", statistics.ticks},
                {"overruns", statistics.overruns},
                {"tick_us", percentiles_json(statistics.tick_ns, 1e3)},
                {"wake_latency_us", percentiles_json(statistics.wake_latency_ns, 1e3)},
                {"force_peak_n", felt.force_peak},
                {"penetration", {{"device_mm", felt.depth_peak}}},
                {"device_travel_mm", felt.travel},
                {"faults", watch.faults_json()}};
    if (felt.recorder)
        result["recording"] = {{"rows", felt.recorder->rows()}, {"lost_rows", statistics.lost_records}};
    return result;
}

}  // namespace
}  // namespace palpate

int main(int argc, char** argv) {
    using namespace palpate;
    cli::Command command(
        {.name = "train",
         .summary = "Opens the trainer's window on an asset",
         .examples = {"palpate train case.vtkhdf",
                      "palpate train case.vtkhdf --script press --seconds 10 --screenshot press.png"},
         .notes =
             "Mouse and keyboard move the hand: drag with the left button in the plane of view, turn the "
             "wheel or press W and S for depth, step with the arrow keys. Drag with the right button to turn "
             "the view; + and - zoom, C cuts the bodies open, B hides the rigid ones, R goes back to the "
             "start, H hides the hints, Q or Escape closes. The window needs an X display; on a machine "
             "without one use 'xvfb-run'.\n"
             "With --device openhaptics[:NAME] or igtl:HOST:PORT[/NAME], as for 'touch', a person's "
             "hand moves the tool. A device of OpenHaptics stands before the picture: its right, up and "
             "towards the user are those of the first view. With touch, desktop or premium mouse and "
             "keyboard, or a script, hold a simulated device that gives way."});
    Options options;
    command.input("asset", options.asset, "the case (.vtkhdf)").required();
    command.option("--size", options.size, "WIDTHxHEIGHT of the window", "pixels");
    command.option("--seconds", options.seconds, "close after this time; 0: when told to", "s");
    command.option(
        "--script", options.script,
        "what the hand does instead of mouse and keyboard: press, slide, tremble, let-go, random or a "
        "file as for 'touch'");
    command.option("--device", options.device,
                   "touch, desktop, premium, openhaptics[:NAME] or igtl:HOST:PORT[/NAME]");
    command.option("--stream", options.stream,
                   "PORT or ADDRESS:PORT at which 3D Slicer and others see the session over OpenIGTLink");
    command.option("--scheme", options.scheme, "how contact is found: continuous, single or twice");
    command.option("--body", options.body, "which body to start at; the first deformable one if not given");
    command.output("--record", options.record,
                   "every tick, for 'palpate touch --replay' (.h5); kept however the trainer ends");
    command.option("--record-seconds", options.record_seconds,
                   "how much of the end a recording holds: 46 MB a minute", "s");
    command.output("--screenshot", options.screenshot, "picture of the window at the end (.png)");
    return command.run(argc, argv, [&](cli::Session& session) { return train(options, session); });
}
