// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/playback/expert_ghost.hpp"

#include <algorithm>

#include "formats/model/arrays.hpp"
#include "runtime/apps/playback/recorded_scene.hpp"
#include "runtime/session/replay.hpp"

namespace palpate::apps {

using namespace training;

ExpertGhost::ExpertGhost(const std::filesystem::path& file, const std::filesystem::path& asset)
    : recording_(recording::read_recording(file)) {
    session::check_asset(recording_, file, asset);
    track_ = session::track_of(recording_, 0, file);
    if (recording_.head.jaws) other_jaw_ = session::track_of(recording_, 1, file);
    demonstration_ = session::demonstration_of(track_);
}

std::vector<visual::OtherTool> ExpertGhost::ghost_at(double moment) const {
    std::vector<visual::OtherTool> ghosts{other_tool_of(session::tick_at(track_, moment))};
    if (other_jaw_) {
        const Tick& other = session::tick_at(*other_jaw_, moment);
        ghosts.front().force += vector_of(other.force);  // what the hand feels
        ghosts.push_back(other_jaw_of(other));
    }
    for (visual::OtherTool& ghost : ghosts) ghost.kind = visual::OtherTool::Kind::ghost;
    return ghosts;
}

std::vector<visual::OtherTool> ExpertGhost::at(double time) const {
    return ghost_at(std::clamp(demonstration_.begins + time, demonstration_.begins, demonstration_.ends));
}

std::vector<visual::OtherTool> ExpertGhost::beside(const Lesson& lesson, double time) const {
    switch (lesson.phase()) {
        case Phase::away:
            return ghost_at(demonstration_.around(time));
        case Phase::counting_down:
            return at(0);
        case Phase::doing: {
            const Attempt& attempt = *lesson.attempt();
            if (attempt.exercise().task == Task::free) return ghost_at(demonstration_.around(attempt.time()));
            return at(attempt.time());
        }
        default:
            return {};
    }
}

}  // namespace palpate::apps
