// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/puncture/puncture_groups.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <numeric>

#include "tools/experiments/statistics.hpp"

namespace palpate::experiments {
namespace {

using Json = nlohmann::ordered_json;
template <typename Value>
using PerGroup = std::array<Value, puncture_groups>;

// Tables 1 and 2 of Zu, Xie, Wang, Min, with the average speeds they state.
struct Published {
    PerGroup<int> punctures;
    PerGroup<double> speeds;
    double mean_speed;
};
const std::array<Published, 2> published{
    {{{1, 2, 2, 2, 0, 1, 2, 2, 0, 2},
      {131.1, 156.8, 143.3, 142.9, 136.5, 143.4, 150.7, 137.0, 144.5, 151.7},
      144.0},
     {{1, 1, 0, 1, 0, 0, 0, 0, 1, 0},
      {156.8, 155.2, 141.9, 151.9, 139.7, 140.8, 152.8, 144.3, 151.8, 146.8},
      148.2}}};

constexpr std::array thickness_classes{0.0, 3.0, 5.0, 7.0, 9.0, 300.0};  // mm

int sum(const PerGroup<int>& values) {
    return std::accumulate(values.begin(), values.end(), 0);
}

std::string count_row(const std::string& name, const PerGroup<int>& counts) {
    std::string text = "| " + name + " |";
    for (const int count : counts) text += fmt::format(" {} |", count);
    return text + fmt::format(" **{}** |\n", sum(counts));
}

std::string speed_row(const PerGroup<double>& speeds, double mean_speed) {
    std::string text = "| mm/s |";
    for (const double speed : speeds) text += fmt::format(" {:.1f} |", speed);
    return text + fmt::format(" {:.1f} |\n", mean_speed);
}

std::string summary_row(const std::string& name, int count) {
    constexpr int trials = puncture_groups * approaches_per_group;
    return fmt::format("| {} | {} | {:.1f} | {} |\n", name, count,
                       static_cast<double>(count) / puncture_groups, chance_text(count, trials));
}

std::string quartiles(const std::vector<double>& values) {
    if (values.empty()) return "–";
    return fmt::format("{:.1f} / {:.1f} / {:.1f}", quantile(values, 0.25), quantile(values, 0.5),
                       quantile(values, 0.75));
}

// How many approaches should be lost, by thickness, speed and pressure alone.
struct Expected {
    double missed = 0;                   // no detection inside the wall, of a tip that nothing slows down
    double far_half = 0;                 // that, or the first detection is nearer to the far side
    int past_middle = 0, past_wall = 0;  // where a tip pressed on an unbroken surface rests
    std::array<double, 4> punctures{};   // by published scheme
};

Expected expect(const GroupRun& run) {
    Expected expected;
    const auto& held = run.outcomes[continuous_scheme];
    for (std::size_t i = 0; i < run.approaches.size(); ++i) {
        const double step = held[i].speed / Approach::detections_per_s;
        const double wall = run.approaches[i].place.thickness;
        const double rest = held[i].held / run.coupling;
        const double far_half = std::max(0.0, 1 - wall / 2 / step);
        const bool past_middle = rest > wall / 2, past_wall = rest > wall;
        expected.missed += std::max(0.0, 1 - wall / step);
        expected.far_half += far_half;
        expected.past_middle += past_middle;
        expected.past_wall += past_wall;
        const std::array lost{past_wall ? 1 : far_half, past_wall ? 1.0 : 0, past_middle ? 1 : far_half,
                              past_middle ? 1.0 : 0};
        for (std::size_t scheme = 0; scheme < lost.size(); ++scheme)
            expected.punctures[scheme] += lost[scheme];
    }
    return expected;
}

Json add_thickness_table(std::string& table, const GroupRun& run) {
    table += "\n" + scheme_columns("wall mm | approaches");
    Json rows = Json::array();
    for (std::size_t c = 0; c + 1 < thickness_classes.size(); ++c) {
        const double from = thickness_classes[c], to = thickness_classes[c + 1];
        int approaches = 0;
        std::array<int, schemes.size()> punctures{};
        for (std::size_t i = 0; i < run.approaches.size(); ++i) {
            const double wall = run.approaches[i].place.thickness;
            if (wall < from || wall >= to) continue;
            ++approaches;
            for (std::size_t scheme = 0; scheme < punctures.size(); ++scheme)
                punctures[scheme] += is_puncture(run.outcomes[scheme][i], run.coupling);
        }
        const bool last = c + 2 == thickness_classes.size();
        table += fmt::format("| {} | {} | {} |\n",
                             last ? fmt::format("{:g} …", from) : fmt::format("{:g} … {:g}", from, to),
                             approaches, fmt::join(punctures, " | "));
        rows.push_back({{"from_mm", from}, {"approaches", approaches}, {"punctures", punctures}});
    }
    return rows;
}

}  // namespace

std::string scheme_columns(const std::string& what) {
    std::string head = "| " + what + " |", rule = "\n|--:|";
    for (const char c : what)
        if (c == '|') rule += "--:|";
    for (const std::string_view name : schemes) {
        head += fmt::format(" {} |", name);
        rule += "--:|";
    }
    return head + rule + "\n";
}

std::string chance_text(int count, int trials) {
    const Interval chance = chance_interval(count, trials);
    return fmt::format("{:.2g} … {:.2g} %", 100 * chance.lower, 100 * chance.upper);
}

Json add_group_tables(std::string& table, const GroupRun& run) {
    table += "## Ten groups of ten\n\n| |";
    std::string rule = "\n|:--|";
    for (std::size_t group = 1; group <= puncture_groups; ++group) {
        table += fmt::format(" {} |", group);
        rule += "--:|";
    }
    table += " total |" + rule + "--:|\n";
    std::string summary =
        "\n| | punctures in 100 | expected per group | 95 % interval of the chance |\n|:--|--:|--:|--:|\n";
    Json result;
    for (std::size_t scheme = 0; scheme < run.outcomes.size(); ++scheme) {
        const std::string name(schemes[scheme]);
        PerGroup<int> punctures{}, pulled{};
        PerGroup<double> speeds{};
        for (std::size_t i = 0; i < run.approaches.size(); ++i) {
            const Outcome& outcome = run.outcomes[scheme][i];
            const std::size_t group = i / approaches_per_group;
            punctures[group] += is_puncture(outcome, run.coupling);
            pulled[group] += is_pulled(outcome);
            speeds[group] += outcome.speed / approaches_per_group;
        }
        table += count_row("**" + name + "**: punctures", punctures) + count_row("pulled", pulled) +
                 speed_row(speeds, std::accumulate(speeds.begin(), speeds.end(), 0.0) / puncture_groups);
        summary += summary_row(name, sum(punctures));
        result[name] = {{"punctures", punctures},
                        {"pulled", pulled},
                        {"speed_mm_s", speeds},
                        {"punctures_total", sum(punctures)},
                        {"pulled_total", sum(pulled)}};
        if (scheme >= published.size()) continue;
        const Published& theirs = published[scheme];
        table += count_row(name + ", published: punctures", theirs.punctures) +
                 speed_row(theirs.speeds, theirs.mean_speed);
        summary += summary_row(name + ", published", sum(theirs.punctures));
    }
    table += summary;
    return result;
}

Json add_reasons(std::string& table, const GroupRun& run) {
    std::vector<double> walls, steps;
    for (std::size_t i = 0; i < run.approaches.size(); ++i) {
        walls.push_back(run.approaches[i].place.thickness);
        steps.push_back(run.outcomes.back()[i].speed / Approach::detections_per_s);
    }
    const Expected expected = expect(run);
    table += fmt::format(
        "\n## Why\n\n"
        "A detection inside the bone anchors the force at the nearest surface point. In the far half of a "
        "wall that is the far side, and the force leads through. The wall, along the approach up to where "
        "the "
        "line first leaves the bone, is {} mm thick (quartiles); the tip goes {:.1f} mm between two "
        "detections.\n\n"
        "- Late: of 100 approaches at these speeds, {:.1f} should pass the whole wall between two "
        "detections, and {:.1f} its near half. `twice` detects within a tick, so this is gone.\n"
        "- Pressed: in {} of 100 the coupling gives way under the hand by more than half the wall, with the "
        "force that `continuous` holds at the end, in {} by more than the whole. A face that is kept bears "
        "the "
        "first. Where every detection renews it, the next one anchors on the far side, and the second test "
        "does not help.\n"
        "- Together that lets expect {:.1f} punctures with `single` and {:g} with `twice`, {:.1f} and {:g} "
        "where the face is renewed.\n\n"
        "The publication states neither the bone's thickness, nor the spring's stiffness, nor how hard was "
        "pressed; its counts follow from these as ours do, so they need not agree.\n\n"
        "| quartiles | first force after ms | tip then mm deep | wall where punctured mm | wall where held "
        "mm |\n"
        "|:--|--:|--:|--:|--:|\n",
        quartiles(walls), mean(steps), expected.missed, expected.far_half, expected.past_middle,
        expected.past_wall, expected.punctures[0], expected.punctures[1], expected.punctures[2],
        expected.punctures[3]);
    Json result{{"thickness_mm", walls},
                {"expected_missed", expected.missed},
                {"expected_far_half", expected.far_half},
                {"expected_past_middle", expected.past_middle},
                {"expected_past_wall", expected.past_wall},
                {"expected_punctures", expected.punctures}};
    for (std::size_t scheme = 0; scheme < run.outcomes.size(); ++scheme) {
        std::vector<double> latency, depth, punctured, held;
        for (std::size_t i = 0; i < run.approaches.size(); ++i) {
            const Outcome& outcome = run.outcomes[scheme][i];
            (is_puncture(outcome, run.coupling) ? punctured : held).push_back(walls[i]);
            if (outcome.latency < 0) continue;
            latency.push_back(1e3 * outcome.latency);
            depth.push_back(outcome.depth_at_force);
        }
        const std::string name(schemes[scheme]);
        table += fmt::format("| {} | {} | {} | {} | {} |\n", name, quartiles(latency), quartiles(depth),
                             quartiles(punctured), quartiles(held));
        result[name] = {{"latency_ms", quantile(latency, 0.5)},
                        {"depth_at_force_mm", quantile(depth, 0.5)},
                        {"thickness_punctured_mm", quantile(punctured, 0.5)},
                        {"thickness_held_mm", quantile(held, 0.5)}};
    }
    result["by_thickness"] = add_thickness_table(table, run);
    return result;
}

}  // namespace palpate::experiments
