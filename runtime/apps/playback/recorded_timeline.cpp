// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/playback/recorded_timeline.hpp"

#include <fmt/format.h>
#include <string>

#include "runtime/texts/translated.hpp"

namespace palpate::apps {
namespace {

using namespace session;

constexpr std::size_t timeline_columns = 600;

// "1/4" for 0.25.
std::string speed_text(double speed) {
    return speed < 1 ? fmt::format("1/{:g}", 1 / speed) : fmt::format("{:g}", speed);
}

}  // namespace

visual::TimelineView timeline_of(const RecordedScene& scene) {
    return {.forces = force_columns(scene.track(), timeline_columns,
                                    [&](const Tick& tick) { return scene.felt(tick); })};
}

void show_time(const PlaybackClock& clock, bool filmed, visual::TimelineView& timeline) {
    timeline.share = clock.share();
    timeline.text = texts::translated("{:.2f} of {:.2f} s    {} x{}", clock.time() - clock.begins(),
                                      clock.ends() - clock.begins(), speed_text(clock.speed()),
                                      clock.runs() || filmed ? "" : "    " + texts::translated("paused"));
}

}  // namespace palpate::apps
