// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/playback/train_playback.hpp"

#include <algorithm>
#include <chrono>
#include <cmath>
#include <fmt/format.h>
#include <iterator>
#include <nlohmann/json.hpp>
#include <optional>
#include <spdlog/spdlog.h>
#include <string>
#include <thread>

#include "formats/asset/asset.hpp"
#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "formats/provenance/cautions.hpp"
#include "runtime/apps/first_sight.hpp"
#include "runtime/apps/playback/expert_ghost.hpp"
#include "runtime/apps/playback/film_output.hpp"
#include "runtime/apps/playback/recorded_scene.hpp"
#include "runtime/apps/playback/recorded_timeline.hpp"
#include "runtime/devices/device_model.hpp"
#include "runtime/session/playback/playback_clock.hpp"
#include "runtime/session/replay.hpp"
#include "runtime/sound/force_sound.hpp"
#include "runtime/texts/translated.hpp"
#include "runtime/visual/train_window.hpp"
#include "tools/cli/refuse_beside.hpp"

namespace palpate::apps {
namespace {

using namespace session;
using namespace visual;

using Clock = std::chrono::steady_clock;
using Json = nlohmann::ordered_json;

// A recording in its window, frame by frame.
class RecordingPlayer {
  public:
    RecordingPlayer(const PlaybackOptions& options, RecordedScene& scene, const ExpertGhost* ghost,
                    TrainWindow& window, VisualFrame& frame)
        : scene_(scene),
          ghost_(ghost),
          window_(window),
          frame_(frame),
          demonstration_(demonstration_of(scene.track())),
          clock_(scene.track().front()->time, scene.track().back()->time, options.speed) {
        frame_.timeline = timeline_of(scene);
    }

    // Until the user or the time ends it.
    void play(double seconds) {
        constexpr auto shortest_frame = std::chrono::nanoseconds(1'000'000'000 / 60);
        const auto began = Clock::now();
        auto frame_began = began;
        const auto passed = [](Clock::time_point since) {
            return std::chrono::duration<double>(Clock::now() - since).count();
        };
        do {
            show(false);
            std::this_thread::sleep_until(frame_began + shortest_frame);
            clock_.advance(passed(std::exchange(frame_began, Clock::now())));
            for (const std::string& key : window_.take_keys()) press(key);
            if (const auto share = window_.take_sought()) clock_.seek_share(*share);
        } while (!ended() && (seconds <= 0 || passed(began) < seconds));
    }

    // From beginning to end.
    void film(FilmOutput& output, int rate, cli::Progress& progress) {
        const double whole = clock_.ends() - clock_.begins(), speed = clock_.speed();
        const auto pictures = 1 + static_cast<std::int64_t>(std::floor(whole * rate / speed));
        frame_.film_rate_hz = rate;
        constexpr int unsteady = 3;  // of a window's first pictures, which choose how much detail there is
        scene_.fill(frame_, clock_.time());
        for (int picture = 0; picture < unsteady; ++picture) window_.show(frame_);
        for (std::int64_t picture = 0; picture < pictures; ++picture) {
            clock_.seek(clock_.begins() + static_cast<double>(picture) * speed / rate);
            show(true);
            if (ended()) throw cli::Interrupted();
            output.take(window_);
            progress.step("filming", static_cast<double>(picture + 1) / static_cast<double>(pictures));
        }
    }

    std::int64_t frames() const { return frames_; }
    double speed() const { return clock_.speed(); }
    std::int64_t shown_ticks() const { return shown_ticks_; }
    double force_peak() const { return force_peak_; }  // N, of what was shown
    const Tick& last() const { return *last_; }        // shown

  private:
    // By the user, or because there is no window any more.
    bool ended() const {
        window_.require_display();
        return window_.closed() || cli::interrupt_asked();
    }

    void press(const std::string& key) {
        if (key == "o" || key == "f" || key == "j")
            window_.tell(texts::translated("not while a recording is shown"));
        if (key == "a") turn_sound();
        clock_.press(key);
    }

    void turn_sound() {
        try {
            sound_.turn();
        } catch (const SystemFailure& error) {
            window_.tell(error.what());
        }
    }

    void show(bool filmed) {
        const Tick& tick = scene_.fill(frame_, clock_.time());
        frame_.audible = sound_.on();
        sound_.follow(clock_.runs() ? frame_.force.norm() : 0);
        if (ghost_)
            std::ranges::move(ghost_->at(clock_.time() - demonstration_.begins),
                              std::back_inserter(frame_.other_tools));
        show_time(clock_, filmed, *frame_.timeline);
        window_.show(frame_);
        window_.require_display();
        ++frames_;
        shown_ticks_ += &tick != last_;
        last_ = &tick;
        force_peak_ = std::max(force_peak_, frame_.force.norm());
    }

    RecordedScene& scene_;
    const ExpertGhost* ghost_;
    TrainWindow& window_;
    VisualFrame& frame_;
    Demonstration demonstration_;
    PlaybackClock clock_;
    sound::ForceSound sound_;
    std::int64_t frames_ = 0, shown_ticks_ = 0;
    double force_peak_ = 0;
    const Tick* last_ = nullptr;
};

// Says what a user would otherwise look for in the window.
void tell_what_is_missing(const recording::Recording& recording, const RecordedTrack& track,
                          const PlaybackOptions& options) {
    const std::string file = options.play.string();
    if (const std::int64_t missing = missing_ticks(track, recording.head.every))
        spdlog::warn("{}: {} ticks are missing; the one before them is shown for as long", file, missing);
    if (recording.rows_unreadable > 0)
        spdlog::warn("{}: {} rows at the end never reached the disk", file, recording.rows_unreadable);
    const auto lost = std::ranges::count_if(track, [&](const Tick* tick) {
        return tick->contact_count > 0 && recording.contacts_of(*tick).empty();
    });
    if (lost > 0)
        spdlog::warn("{}: the contacts of {} ticks were overwritten; surfaces are at rest there", file, lost);
    if (const std::size_t tools = recording.head.devices.size(); tools > 1 && !recording.head.jaws)
        spdlog::info("{}: tool {} of {} is followed, the others are shown beside it", file, options.tool,
                     tools);
}

}  // namespace

std::function<void()> declare_playback(cli::Command& command, PlaybackOptions& options,
                                       std::vector<cli::Option> beside) {
    const cli::Option play =
        command.input("--play", options.play,
                      "show this recording of a run instead, with its own forces (.h5 of --record)");
    beside.push_back(play);
    beside.push_back(
        command.input("--ghost", options.ghost,
                      "a recording of an expert, whose tool is shown as a ghost beside one's own"));
    beside.push_back(
        command.option("--tool", options.tool, "of --play: which of several is followed, from 0 on")
            .range(0, recording::most_recorded_tools - 1)
            .needs(play));
    beside.push_back(
        command.option("--speed", options.speed, "of --play at first: 1/8 to 4 times as fast as it was")
            .range(PlaybackClock::slowest, PlaybackClock::fastest)
            .needs(play));
    beside.push_back(
        command.output("--video", options.video, "film of --play from beginning to end (.ogv)").needs(play));
    beside.push_back(
        command
            .output("--pictures", options.pictures, "the same as a folder of pictures (.png), which is made")
            .needs(play));
    beside.push_back(command.option("--film-rate", options.film_rate, "pictures a second of --video", "Hz")
                         .range(1, 120)
                         .needs(play));
    return [&command, play, beside] {
        if (play.given())
            cli::refuse_beside(command, "--play", beside, "a recording says itself what the run was like");
    };
}

Json play_recording(const PlaybackOptions& options, const PlaybackWindow& shown, cli::Session& session) {
    std::optional<cli::StagedFile> picture;
    if (!shown.screenshot.empty()) picture.emplace(shown.screenshot, session.force);
    FilmOutput film(options.video, options.pictures, options.film_rate, session);

    auto opened = open_window(shown.size, texts::translated("reading {}", options.play.filename().string()));
    session.progress.step("reading the recording", 0);
    const recording::Recording recording = recording::read_recording(options.play);
    session.progress.step("reading the case", 0.3);
    Case patient_case = recorded_case(recording, options.play, shown.asset, shown.trusted_keys);
    patient_case.hyperelastic.clear();  // it shows what contacts make of the compliance
    const auto model = model_of(recording, options.play, patient_case);
    RecordedScene scene(recording, options.play, options.tool, *model, patient_case);
    std::optional<ExpertGhost> ghost;
    if (!options.ghost.empty()) ghost.emplace(options.ghost, shown.asset);
    cli::end_softly_on_interrupt();

    session.progress.step("filling the window", 0.5);
    WindowSettings settings{.start = vector_of(scene.track().front()->tool_position),
                            .sight = scene.sight(),
                            .cautions = provenance::cautions_in(patient_case.provenance),
                            .surfaces = surfaces_of(*model)};
    const auto tool = static_cast<std::size_t>(options.tool);
    if (const auto* model = devices::model_of_device(recording.head.devices[tool].name))
        settings.rendered = model->coulomb_friction;
    if (const auto& jaws = recording.head.jaws) settings.jaw_length = jaws->jaw_length;
    TrainWindow window(std::move(opened), patient_case, settings);
    session.progress.finish();
    tell_what_is_missing(recording, scene.track(), options);
    VisualFrame frame;
    for (const DeformableBody& body : patient_case.deformable_bodies)
        frame.displacements.emplace_back(body.boundary.nodes.size());
    RecordingPlayer player(options, scene, ghost ? &*ghost : nullptr, window, frame);
    const auto began = Clock::now();
    if (film.asked())
        player.film(film, options.film_rate, session.progress);
    else
        player.play(shown.seconds);
    const double seconds = std::chrono::duration<double>(Clock::now() - began).count();
    session.progress.finish();
    if (cli::interrupt_asked()) throw cli::Interrupted();
    film.commit();
    if (picture) {
        window.save_picture(picture->path());
        picture->commit();
    }

    const Tick& last = player.last();
    const RecordedTrack& track = scene.track();
    session.form = "playback";
    Json result{{"case", patient_case.name},
                {"scheme", recording.head.scheme},
                {"device", recording.head.devices[options.tool].name},
                {"tool", options.tool},
                {"ticks", track.size()},
                {"missing_ticks", missing_ticks(track, recording.head.every)},
                {"begins_s", track.front()->time},
                {"ends_s", track.back()->time},
                {"speed", player.speed()},
                {"frames", player.frames()},
                {"frames_per_second", static_cast<double>(player.frames()) / seconds},
                {"shown_ticks", player.shown_ticks()},
                {"force_peak_n", player.force_peak()},
                {"last",
                 {{"tick", last.tick},
                  {"time_s", last.time},
                  {"force_n", array_of(scene.felt(last))},
                  {"contacts", recording.contacts_of(last).size()}}}};
    if (ghost)
        result["ghost"] = {{"begins_s", ghost->demonstration().begins},
                           {"ends_s", ghost->demonstration().ends}};
    if (film.asked())
        result["film"] = {{"pictures", player.frames()}, {"pictures_per_second", options.film_rate}};
    return result;
}

}  // namespace palpate::apps
