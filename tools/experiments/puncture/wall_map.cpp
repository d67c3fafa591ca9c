// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/puncture/wall_map.hpp"

#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <optional>

#include "tools/experiments/rigid_case.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using drawing::Chart;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr int wall_approaches = 100;
constexpr double published_single = 14, published_twice = 4;  // in 100
const Vector3d off_the_diagonal{7, 19, 0};                    // mm, on the plate

// Where, between two hands, the wall at which `single` loses 14 is the one at which `twice` loses 4.
struct Meeting {
    double hand, wall;  // N/mm, mm
};
std::optional<Meeting> meeting_of(const WallMap::Counts& counts) {
    for (std::size_t h = 0; h + 1 < hands.size(); ++h) {
        const double single = wall_at(counts.single[h], published_single),
                     next_single = wall_at(counts.single[h + 1], published_single),
                     difference = wall_at(counts.twice[h], published_twice) - single,
                     next_difference = wall_at(counts.twice[h + 1], published_twice) - next_single;
        if (!(difference * next_difference <= 0) || difference == next_difference) continue;
        const double part = difference / (difference - next_difference);
        return Meeting{std::lerp(hands[h], hands[h + 1], part), std::lerp(single, next_single, part)};
    }
    return std::nullopt;
}

std::string wall_text(double wall) {
    return std::isnan(wall) ? fmt::format("> {:g}", walls.back()) : fmt::format("{:.1f}", wall);
}

}  // namespace

int punctures_of_wall(std::string_view scheme, const DeviceModel& device, double wall,
                      double hand_stiffness) {
    haptics::HapticModel model(rigid_case("plate", plate_surface(wall), approach_settings), scheme);
    const DeviceLimits limits = limits_of(device);
    model.couple_to({&limits, 1});
    Approach approach{
        .place = {.entry = off_the_diagonal, .direction = -Vector3d::UnitZ(), .thickness = wall}};
    approach.hand.stiffness = hand_stiffness;
    int punctures = 0;
    for (int i = 0; i < wall_approaches; ++i) {
        approach.phase = (i + 0.5) / wall_approaches;
        punctures +=
            is_puncture(run_approach(model, device, approach, false), model.coupling(), hand_stiffness);
    }
    return punctures;
}

WallMap map_walls(const DeviceModel& device) {
    WallMap map{.of_reading = {}, .coupling = approach_settings.coupling_stiffness};
    for (std::size_t reading = 0; reading < readings.size(); ++reading)
        for (std::size_t h = 0; h < hands.size(); ++h)
            for (std::size_t w = 0; w < walls.size(); ++w) {
                WallMap::Counts& counts = map.of_reading[reading];
                counts.single[h][w] = punctures_of_wall(readings[reading].single, device, walls[w], hands[h]);
                counts.twice[h][w] = punctures_of_wall(readings[reading].twice, device, walls[w], hands[h]);
            }
    return map;
}

double wall_at(const std::array<int, walls.size()>& counts, double count) {
    for (std::size_t w = walls.size(); w-- > 0;) {
        if (counts[w] <= count) continue;
        if (w + 1 == walls.size()) return std::numeric_limits<double>::quiet_NaN();
        return std::lerp(walls[w], walls[w + 1], (counts[w] - count) / (counts[w] - counts[w + 1]));
    }
    return walls.front();
}

Json add_wall_tables(std::string& table, const WallMap& map) {
    table += fmt::format(
        "\n## By wall and pressure\n\n"
        "The publication states neither how thick the bone is nor how hard is pressed. Here the bone is a "
        "plate of one thickness, and the hand's spring is what presses: {} approaches at {:g} mm/s, the "
        "detection loop's phases spread evenly. The coupling, {:g} N/mm, gives way by the depth. A cell says "
        "how often the tool got through before the improvement / after it. Published are {:g} / {:g}: the "
        "last "
        "rows say at which wall each count is met, interpolated between whole mm.\n",
        wall_approaches, Approach{}.speed, map.coupling, published_single, published_twice);
    Json result{{"walls_mm", walls}, {"hands_n_per_mm", hands}};
    for (std::size_t reading = 0; reading < readings.size(); ++reading) {
        const auto& [name, single, twice] = readings[reading];
        const WallMap::Counts& counts = map.of_reading[reading];
        table += fmt::format("\n| {}: wall, mm |", name);
        std::string rule = "\n|--:|", depths = "| depth at rest, mm |";
        std::string of_single = fmt::format("| wall where `{}` loses {:g} |", single, published_single);
        std::string of_twice = fmt::format("| wall where `{}` loses {:g} |", twice, published_twice);
        for (std::size_t h = 0; h < hands.size(); ++h) {
            table += fmt::format(" {:g} N/mm |", hands[h]);
            rule += "--:|";
            depths += fmt::format(" {:.1f} |", unbroken_force(map.coupling, hands[h]) / map.coupling);
            of_single += fmt::format(" {} |", wall_text(wall_at(counts.single[h], published_single)));
            of_twice += fmt::format(" {} |", wall_text(wall_at(counts.twice[h], published_twice)));
        }
        table += rule + "\n";
        for (std::size_t w = 0; w < walls.size(); ++w) {
            table += fmt::format("| {:g} |", walls[w]);
            for (std::size_t h = 0; h < hands.size(); ++h)
                table += fmt::format(" {} / {} |", counts.single[h][w], counts.twice[h][w]);
            table += "\n";
        }
        table += depths + "\n" + of_single + "\n" + of_twice + "\n";
        Json& entry = result[std::string(single)];
        entry = {{"single", counts.single}, {"twice", counts.twice}};
        const std::optional<Meeting> meeting = meeting_of(counts);
        if (meeting) entry["both_at"] = {{"wall_mm", meeting->wall}, {"hand_n_per_mm", meeting->hand}};
        table += meeting ? fmt::format("\nBoth are met by a wall of {:.1f} mm and a hand of {:.2g} N/mm.\n",
                                       meeting->wall, meeting->hand)
                         : "\nNo wall and hand among these meet both.\n";
    }
    return result;
}

std::vector<Chart> wall_charts(const WallMap& map) {
    std::vector<Chart> charts;
    for (std::size_t reading = 0; reading < readings.size(); ++reading) {
        const auto& [name, single, twice] = readings[reading];
        const WallMap::Counts& counts = map.of_reading[reading];
        Chart& chart = charts.emplace_back();
        chart.title = fmt::format("Where the published counts lie, {}", name);
        chart.x_label = "stiffness of the pressing hand [N/mm]";
        chart.y_label = "thickness of the wall [mm]";
        chart.log_x = true;
        chart.series = {{.name = fmt::format("{}: {:g} of 100", single, published_single)},
                        {.name = fmt::format("{}: {:g} of 100", twice, published_twice)}};
        for (std::size_t h = 0; h < hands.size(); ++h) {
            chart.series[0].x.push_back(hands[h]);
            chart.series[0].y.push_back(wall_at(counts.single[h], published_single));
            chart.series[1].x.push_back(hands[h]);
            chart.series[1].y.push_back(wall_at(counts.twice[h], published_twice));
        }
        if (const std::optional<Meeting> meeting = meeting_of(counts))
            chart.series.push_back(
                {.name = "14 and 4", .x = {meeting->hand}, .y = {meeting->wall}, .markers = true});
    }
    return charts;
}

}  // namespace palpate::experiments
