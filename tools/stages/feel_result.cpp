// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/feel_result.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include "formats/model/regions.hpp"

namespace palpate::stages {
namespace {

using Json = nlohmann::ordered_json;

double force_difference(const FeltRegion& felt, double depth) {
    return (felt.stiffness - felt.stiffness_without) * depth;
}

// What a hand misses: "changes the stiffness by 1.2 %, where a hand tells 15 %".
std::string shortfall(const FeltRegion& felt, double depth) {
    const double percent = 100 * contrast_of(felt);
    switch (verdict_of(felt, depth)) {
        case FeltVerdict::too_faint:
            return fmt::format("changes the stiffness by {:.2g} %, where a hand tells {:g} %", percent,
                               100 * told_contrast);
        case FeltVerdict::too_varied:
            return fmt::format(
                "changes the stiffness by {:.2g} %, less than the {:.2g} % by which it varies "
                "around there anyway",
                percent, 100 * felt.variation);
        case FeltVerdict::too_weak:
            return fmt::format(
                "changes the force on a press of {:g} mm by {:.2g} N, where a device renders "
                "{:g} N",
                depth, force_difference(felt, depth), rendered_force);
        case FeltVerdict::felt:
            break;
    }
    return "can be felt";
}

}  // namespace

std::vector<Json> felt_rows(const DeformableBody& body) {
    std::vector<Json> rows;
    if (!body.feel) return rows;
    for (const FeltRegion& felt : body.feel->regions) {
        const Eigen::Vector3d& place = body.boundary.surface.vertices[static_cast<std::size_t>(felt.vertex)];
        rows.push_back({{"body", body.name},
                        {"region", region_name(body.mesh, felt.region)},
                        {"verdict", verdict_word(verdict_of(felt, body.feel->depth))},
                        {"contrast_percent", 100 * contrast_of(felt)},
                        {"variation_percent", 100 * felt.variation},
                        {"force_difference_n", force_difference(felt, body.feel->depth)},
                        {"stiffness_n_per_mm", felt.stiffness},
                        {"stiffness_without_n_per_mm", felt.stiffness_without},
                        {"depth_mm", felt.depth},
                        {"vertex", felt.vertex},
                        {"place_mm", {place.x(), place.y(), place.z()}}});
    }
    return rows;
}

Json feel_summary(const DeformableBody& body) {
    if (!body.feel) return nullptr;
    std::vector<float> pressed;
    std::ranges::copy_if(body.feel->stiffness, std::back_inserter(pressed), [](float k) { return k > 0; });
    if (pressed.empty()) return nullptr;
    std::ranges::sort(pressed);
    return {{"body", body.name},
            {"tool_radius_mm", body.feel->tool_radius},
            {"press_mm", body.feel->depth},
            {"least_n_per_mm", pressed.front()},
            {"median_n_per_mm", pressed[pressed.size() / 2]},
            {"largest_n_per_mm", pressed.back()}};
}

std::string unfelt_warning(const DeformableBody& body, const FeltRegion& felt,
                           std::span<const fem::FeltTrial> trials) {
    std::string would_do, would_not;
    for (const fem::FeltTrial& trial : trials) {
        std::string& list = trial.verdict == FeltVerdict::felt ? would_do : would_not;
        list += fmt::format("{}{} ({:.2g} %)", list.empty() ? "" : ", ", trial.change,
                            100 * contrast_of(trial.felt));
    }
    return fmt::format(
        "'{}' of '{}' cannot be felt with this tool: where it is felt best, {:.1f} mm above it, it {}; {}",
        region_name(body.mesh, felt.region), body.name, felt.depth, shortfall(felt, body.feel->depth),
        would_do.empty()
            ? fmt::format("try it nearer to the surface and larger at once, for none of these alone "
                          "would do: {}",
                          would_not)
            : fmt::format("try it {}", would_do));
}

}  // namespace palpate::stages
