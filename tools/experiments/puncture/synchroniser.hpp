// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <string>
#include <string_view>
#include <vector>

#include "formats/drawing/chart.hpp"
#include "runtime/devices/hand_path.hpp"
#include "tools/experiments/puncture/approach_run.hpp"

namespace palpate::experiments {

/// How the answers of the collision loop come to the servo (§4.2 of the paper named in
/// published_contact.hpp).
enum class Crossing {
    late,          ///< before: with the next turn of the visual loop, so of a position that is a turn old
    synchronised,  ///< after: at once
};

/// What a hand felt that presses, slides and leaves. Outwards is positive.
struct TouchFigures {
    double first_force_s = -1;  ///< from the start to the first force; -1: there was none
    double largest_step = 0;    ///< of the force from tick to tick, N
    double roughness = 0;       ///< RMS of dF/dt while there is force, N/s
    double pull = 0;            ///< largest force inwards, N
    std::vector<double> force;  ///< outwards, N, for each ms
};

/// Runs `path` with a published scheme on virtual time: each ms read, tick, write; the collision loop turns
/// 30 times a second from `phase` on. The model forgets what was before.
TouchFigures touch_published(haptics::HapticModel& model, const devices::DeviceModel& device,
                             const devices::HandPath& path, const Eigen::Vector3d& outwards, double phase,
                             Crossing crossing);

/// Before and after the published synchroniser, as figures 6 (bone) and 8 (soft tissue) show it.
struct SynchroniserRun {
    struct Row {
        std::string body;
        std::string_view scheme;
        Crossing crossing;
        double largest_step = 0, roughness = 0, pull = 0;  // means over the touches
    };
    std::vector<Row> rows;
    std::vector<drawing::Chart> charts;
};

/// Touches the bone at `place`, and an ellipsoid of soft tissue, with both schemes and both crossings.
SynchroniserRun compare_synchronisers(const Case& bone, const Place& place,
                                      const devices::DeviceModel& device);

/// Appends the table. Returns the figures.
nlohmann::ordered_json add_synchroniser_table(std::string& table, const SynchroniserRun& run);

}  // namespace palpate::experiments
