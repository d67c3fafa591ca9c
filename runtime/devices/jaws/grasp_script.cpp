// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/jaws/grasp_script.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "runtime/devices/hand_path.hpp"
#include "runtime/devices/jaws/jaws.hpp"

namespace palpate::devices {
namespace {

using Eigen::Vector3d;

void check(const GraspSettings& settings) {
    require_script("--speed", settings.speed, settings.speed > 0, "more than 0 mm/s");
    require_script("--depth", settings.pull, settings.pull >= 0, "0 mm or more");
    require_script("--seconds", settings.seconds, settings.seconds > 0, "more than 0 s");
}

}  // namespace

HandPath grasp_path(const Grasp& grasp, const JawSettings& jaws, const GraspSettings& settings) {
    check(settings);
    const double opened = open_angle(jaws);
    const double left = std::min(1.0, (1 - settings.pinch) * grasp.thickness / (2 * jaws.jaw_length));
    const double closed = std::min(opened, 2 * std::asin(left));
    const Vector3d outside = grasp.outside(), away = grasp.meet + settings.pull * grasp.out();
    std::vector<HandPath::Key> keys{{0, outside, true, grasp.orientation, opened}};
    const auto go = [&](double seconds, const Vector3d& meet, double angle) {
        if (seconds > 0) keys.push_back({keys.back().time + seconds, meet, true, grasp.orientation, angle});
    };
    const auto move = [&](const Vector3d& meet) {
        go((meet - keys.back().position).norm() / settings.speed, meet, keys.back().jaw_angle);
    };
    const auto turn = [&](double angle) {
        go(std::abs(angle - keys.back().jaw_angle) / closing_speed, keys.back().position, angle);
    };
    const auto hold = [&] { go(settings.hold_s, keys.back().position, keys.back().jaw_angle); };
    do {
        move(grasp.meet);
        turn(closed);
        hold();
        move(away);
        hold();
        move(grasp.meet);
        turn(opened);
        move(outside);
        hold();
    } while (keys.back().time < settings.seconds);
    return HandPath(std::move(keys));
}

}  // namespace palpate::devices
