// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/train_run.hpp"

#include <algorithm>
#include <chrono>
#include <iterator>
#include <span>
#include <string>
#include <thread>
#include <vector>

#include "formats/model/arrays.hpp"
#include "runtime/apps/playback/recorded_scene.hpp"
#include "runtime/apps/servo_pulse.hpp"
#include "runtime/session/drawn_shape.hpp"
#include "runtime/session/jaws/joined_jaws.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {
namespace {

using namespace visual;

using Clock = std::chrono::steady_clock;

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

// What the run says of itself. `ticks`: of each tool, of which the first is shown as the one that is held.
void fill_frame(const TrainRun& run, std::span<const TickResult* const> ticks, VisualFrame& frame) {
    const TickResult& tick = *ticks.front();
    frame.device_position = vector_of(tick.device_position);
    frame.tool_position = vector_of(tick.tool_position);
    frame.force = vector_of(tick.force);
    if (run.session.jaws()) frame.force += vector_of(ticks[1]->force);
    frame.torque = vector_of(tick.torque);
    frame.depth = tick.depth;
    frame.overruns = tick.overruns;
    if (run.shows_shaft) frame.shaft = vector_of(tick.shaft);
    frame.tool_orientation = quaternion_of(tick.tool_orientation);
    frame.faults = run.session.recent_faults(tick.time);
    frame.statuses = run.session.statuses().recent(tick.time);
    frame.recording = run.keys.recording();
    frame.audible = run.keys.sound().on();
    frame.deforming_far = run.session.deforming_far();
    frame.lesson = run.lesson.view(frame.force.norm(), frame.tool_position);
    frame.other_tools.clear();
    for (const TickResult* other : ticks.subspan(1))
        frame.other_tools.push_back(run.session.jaws() ? other_jaw_of(*other) : other_tool_of(*other));
    if (run.session.jaws()) frame.jaws_closed = run.session.jaws_closed();
    if (run.ghost)
        std::ranges::move(run.ghost->beside(run.lesson.lesson(), tick.time),
                          std::back_inserter(frame.other_tools));
}

// An attempt in place of what is felt now, `seconds` later than in the last frame.
void show_again(const TrainRun& run, AttemptReview& review, double seconds, VisualFrame& frame) {
    if (const auto share = run.window.take_sought()) review.seek(*share);
    review.show(seconds, frame);
    if (!run.shows_shaft) frame.shaft.setZero();
    frame.force_range.setConstant(frame.force.norm());
    frame.lesson = run.lesson.view(0, frame.tool_position);
}

// What the hand did in the last tick.
TickResult hand_tick(session::Session& session) {
    if (session.jaws())
        return session::joined_jaws(session.latest(0), session.latest(1), session.jaws()->jaw_length);
    TickResult tick;
    copy_active(session.latest(), tick);
    return tick;
}

void take_keys(const TrainRun& run, bool page_takes_them) {
    for (const std::string& key : run.window.take_keys()) {
        const TickResult tick = hand_tick(run.session);
        run.lesson.press(key, tick);
        if (page_takes_them) continue;
        const std::string told = run.keys.press(key, run.lesson.lesson().exercising());
        if (!told.empty()) run.window.tell(told);
    }
}

// Nothing is left out between frames, so that a tap is seen that was quicker.
void widen(Eigen::Vector2d& range, double newtons) {
    range = {std::min(range[0], newtons), std::max(range[1], newtons)};
}

}  // namespace

void Felt::add(const TickResult& tick) {
    const Eigen::Vector3d position = vector_of(tick.device_position);
    force_peak = std::max(force_peak, vector_of(tick.force).norm());
    depth_peak = std::max(depth_peak, tick.depth);
    if (tick.tool > 0) return;
    if (last_position) travel += (position - *last_position).norm();
    last_position = position;
}

TrainOutcome run_in_window(const TrainRun& run, VisualFrame& frame) {
    constexpr auto shortest_frame = std::chrono::nanoseconds(1'000'000'000 / 60);
    session::Session& session = run.session;
    TrainOutcome outcome;
    TickResult first_jaw;
    const auto take_one = [&](const TickResult& tick) {
        outcome.felt.add(tick);
        run.lesson.take(tick);
        if (tick.tool == 0) widen(frame.force_range, vector_of(tick.force).norm());
    };
    const session::Session::Sink take = [&](const TickResult& tick) {
        run.lesson.record(tick);
        if (!session.jaws()) return take_one(tick);
        // Of a forceps the exercise sees what the hand that holds both jaws does.
        if (tick.tool == 0)
            copy_active(tick, first_jaw);
        else
            take_one(session::joined_jaws(first_jaw, tick, session.jaws()->jaw_length));
    };
    TickRate rate;
    ServoPulse pulse;
    session::DrawnShape shape(session.patient_case());
    std::vector<const TickResult*> ticks(session.model().tool_count());
    session.start();
    const auto began = Clock::now();
    auto frame_began = began;
    double frame_seconds = 0;   // that the last one took
    VisualFrame again = frame;  // of an attempt that is shown again
    bool page_takes_keys = false;
    const auto elapsed = [&] { return std::chrono::duration<double>(Clock::now() - began).count(); };
    while (!run.window.closed() && !run.window.lost() && !cli::interrupt_asked() &&
           (run.seconds <= 0 || elapsed() < run.seconds)) {
        take_keys(run, page_takes_keys);
        for (std::size_t tool = 0; tool < ticks.size(); ++tool) ticks[tool] = &session.latest(tool);
        const TickResult& tick = *ticks.front();
        pulse.see(tick.tick);
        const auto led_hand = run.lesson.hand(run.window.hand());
        const double tick_rate = rate.update(tick.tick);
        AttemptReview* const review = run.lesson.review();
        VisualFrame& shown = review != nullptr ? again : frame;
        if (review != nullptr) {
            show_again(run, *review, frame_seconds, again);
        } else {
            frame.tick_rate_hz = tick_rate;
            shape.follow(session.model(), tick.time, ticks, frame.displacements);
            fill_frame(run, ticks, frame);
        }
        const double drawn = tick.time;
        run.window.show(shown);
        page_takes_keys = shown.lesson.takes_keys;
        // Mouse and keys do not take it off its way: it would come back through what lies between.
        if (led_hand) run.window.place_hand(*led_hand);
        const double late = session.latest().time - drawn;
        outcome.late_ns.record(static_cast<std::uint64_t>(1e9 * std::max(0.0, late)));
        run.keys.sound().follow(review == nullptr || review->runs() ? shown.force.norm() : 0);
        session.visual_beat();
        if (review == nullptr) session.guide(run.window.hand(), run.window.held_orientation());
        frame.force_range.setConstant(frame.force.norm());
        session.pump(take);
        std::this_thread::sleep_until(frame_began + shortest_frame);
        const auto now = Clock::now();
        outcome.frame_ns.record(
            static_cast<std::uint64_t>(std::chrono::nanoseconds(now - frame_began).count()));
        frame_seconds = std::chrono::duration<double>(now - frame_began).count();
        frame_began = now;
    }
    outcome.seconds = elapsed();
    session.stop();
    session.pump(take);
    run.lesson.close();
    return outcome;
}

}  // namespace palpate::apps
