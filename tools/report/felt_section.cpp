// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cmath>
#include <fmt/format.h>

#include "tools/report/html.hpp"
#include "tools/report/pictures/colour_scale.hpp"
#include "tools/report/sections.hpp"

namespace palpate::report {
namespace {

const Label& region_label(const DeformableBody& body, std::int32_t region) {
    return *std::ranges::find(body.mesh.region_names, region, &Label::value);
}

std::vector<std::string> felt_row(const DeformableBody& body, const FeltRegion& felt) {
    const double press = body.feel->depth;
    const FeltVerdict verdict = verdict_of(felt, press);
    const Eigen::Vector3d& place = body.boundary.surface.vertices[static_cast<std::size_t>(felt.vertex)];
    return {html::escaped(body.name),
            swatch(region_label(body, felt.region)),
            fmt::format("<span class=\"{}\">{}</span> {}", verdict == FeltVerdict::felt ? "yes" : "no",
                        verdict == FeltVerdict::felt ? "✓" : "✗", verdict_word(verdict)),
            fmt::format("{:+.1f} %", 100 * contrast_of(felt)),
            fmt::format("{:.1f} %", 100 * felt.variation),
            fmt::format("{:+.3f}", (felt.stiffness - felt.stiffness_without) * press),
            fmt::format("{:.4f}", felt.stiffness_without),
            fmt::format("{:.4f}", felt.stiffness),
            fmt::format("{:.1f}", felt.depth),
            fmt::format("{:.1f}, {:.1f}, {:.1f}", place.x(), place.y(), place.z())};
}

// The mean of the corners' values.
std::vector<double> values_of_triangles(const TriangleMesh& surface, const std::vector<float>& values) {
    std::vector<double> means;
    for (const Triangle& t : surface.triangles) {
        double sum = 0;
        for (const std::int32_t v : t) sum += static_cast<double>(values[static_cast<std::size_t>(v)]);
        means.push_back(sum / 3);
    }
    return means;
}

std::string map_of(const PictureWindow& window, const DeformableBody& body) {
    const Feel& feel = *body.feel;
    const TriangleMesh& surface = body.boundary.surface;
    const std::vector<double> values = values_of_triangles(surface, feel.stiffness);
    const ColourScale scale = scale_for(values);
    auto marked = static_cast<std::size_t>(std::ranges::max_element(feel.stiffness) - feel.stiffness.begin());
    std::string name = "stiffest";
    if (!feel.regions.empty()) {
        const FeltRegion& best = *std::ranges::max_element(
            feel.regions, {}, [](const FeltRegion& felt) { return std::abs(contrast_of(felt)); });
        marked = static_cast<std::size_t>(best.vertex);
        name = region_label(body, best.region).name;
    }
    return "<h3>" + html::escaped(body.name) +
           fmt::format(
               "</h3>\n<p>Force by depth of a sphere of {:g} mm radius, pressed {:g} mm deep; palest where "
               "the body cannot be pressed. The ring is {}; it may lie behind what is seen.</p>\n",
               feel.tool_radius, feel.depth,
               feel.regions.empty() ? "the stiffest place" : "where a region changes it most") +
           figures_of(
               coloured_pictures(window, surface, values, scale, surface.vertices[marked], directions()),
               body.name, {name}) +
           "<figure>" + scale_svg(scale, "N/mm") + "</figure>\n";
}

}  // namespace

std::string felt_section(const ReportPage& page) {
    std::vector<std::vector<std::string>> rows;
    std::string maps;
    for (const DeformableBody& body : page.inputs.patient_case.deformable_bodies) {
        if (!body.feel) continue;
        for (const FeltRegion& felt : body.feel->regions) rows.push_back(felt_row(body, felt));
        maps += map_of(*page.window, body);
    }
    if (maps.empty()) return "";
    const std::string table = rows.empty() ? ""
                                           : html::table({{"Body"},
                                                          {"Region"},
                                                          {"To a hand"},
                                                          {"Contrast", true},
                                                          {"Variation", true},
                                                          {"Force, N", true},
                                                          {"Without, N/mm", true},
                                                          {"With, N/mm", true},
                                                          {"Depth, mm", true},
                                                          {"Place L, P, S in mm", true}},
                                                         rows);
    return html::section(
        "felt", "What can be felt",
        fmt::format(
            "How stiff each body is by itself under the tool, and what each region changes in that where it "
            "changes most of it, against the same body with the region of the material around it. A hand "
            "tells a region whose contrast is {:g} % or more (the Weber fraction of compliance, Tiest and "
            "Kappers 2009) and no less than the stiffness varies by around there anyway, if it changes the "
            "force by {:g} N (the friction of a Touch X; a Touch has 0.26 N).",
            100 * told_contrast, rendered_force),
        table + maps);
}

}  // namespace palpate::report
