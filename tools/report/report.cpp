// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/report.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <span>

#include "formats/provenance/cautions.hpp"
#include "tools/report/html.hpp"
#include "tools/report/page_style.hpp"
#include "tools/report/pictures/virtual_display.hpp"
#include "tools/report/sections.hpp"

namespace palpate::report {
namespace {

std::string verdict(const std::vector<MeasuredBody>& bodies) {
    if (bodies.empty()) return "";
    std::string failures;
    double residual = 0, angle = 180;
    for (const MeasuredBody& measured : bodies) {
        residual = std::max(residual, measured.body.certificate.residual);
        angle = std::min(angle, measured.mesh.min_dihedral_deg);
        for (const Check& check : measured.checks)
            if (!check.holds)
                failures +=
                    fmt::format("<div>{}: {} is {}, must be {}</div>", html::escaped(measured.body.name),
                                check.name, check.value, check.limit);
    }
    if (!failures.empty())
        return "<div class=\"verdict failed\"><strong>✗ Not verified</strong><div>" + failures +
               "</div></div>\n";
    return fmt::format(
        "<div class=\"verdict\"><strong>✓ Verified</strong><div>The asset’s digests match and every figure "
        "of "
        "the certificate is within its limit. Worst residual {}, smallest dihedral angle "
        "{:.1f}°.</div></div>\n",
        html::significant(residual, 2), angle);
}

// What the verdict is not about: how the case was made. Empty if its provenance tells nothing of it.
std::string cautions(const std::string& provenance) {
    std::string items;
    for (const std::string& caution : provenance::cautions_in(provenance))
        items += "<li>" + html::escaped(caution) + "</li>\n";
    if (items.empty()) return "";
    return "<div class=\"cautions\"><strong>What that does not say</strong><ul>" + items + "</ul></div>\n";
}

std::string key_figures(const ReportInputs& inputs, const std::vector<MeasuredBody>& bodies) {
    std::size_t tetrahedra = 0, contact_nodes = 0, triangles = 0;
    double volume = 0;
    for (const MeasuredBody& measured : bodies) {
        tetrahedra += measured.body.mesh.tetrahedra.size();
        contact_nodes += measured.body.contact_nodes.size();
        for (const double region : measured.mesh.region_volumes) volume += region;
    }
    for (const RigidBody& body : inputs.patient_case.rigid_bodies) triangles += body.surface.triangles.size();
    const auto whole = [](std::size_t value) { return html::grouped(static_cast<std::int64_t>(value)); };
    std::vector<html::Card> result{{"Deformable volume", fmt::format("{:.0f}", volume / 1000), "ml"},
                                   {"Tetrahedra", whole(tetrahedra), ""},
                                   {"Contact nodes", whole(contact_nodes), ""},
                                   {"Rigid triangles", whole(triangles), ""}};
    if (const auto& scan = inputs.patient_case.scan)
        result.push_back(
            {"Scan for the eye",
             fmt::format("{} × {} × {}", scan->grid.size[0], scan->grid.size[1], scan->grid.size[2]),
             "voxels"});
    if (!inputs.stages.empty()) {
        double seconds = 0;
        for (const StageRecord& stage : inputs.stages) seconds += stage.seconds;
        result.push_back({"Built in", fmt::format("{:.1f}", seconds), "s"});
    }
    return html::cards(result);
}

std::string page_html(const ReportPage& page, const std::string& header, std::span<const Section> sections) {
    const std::string name = html::escaped(page.inputs.patient_case.name);
    std::string navigation, content;
    for (const Section& section : sections) {
        navigation += fmt::format("<a href=\"#{}\">{}</a>", section.anchor, section.title);
        content += section.make(page);
    }
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>" +
           name + " – Palpate report</title>\n<style>" + std::string(page_style) +
           "</style>\n</head>\n<body>\n<main>\n<header>\n<p class=\"kind\">Palpate report</p>\n<h1>" + name +
           "</h1>\n" + header + "</header>\n<nav>" + navigation + "</nav>\n" + content +
           "<footer>Lengths in mm, positions in the patient frame: L left, P posterior, S superior (LPS). "
           "Not a "
           "medical device; not for diagnosis or treatment.</footer>\n</main>\n</body>\n</html>\n";
}

}  // namespace

std::string html_failure(const ReportInputs& inputs, const std::string& message) {
    constexpr Section sections[] = {{"slices", "Slices", slices_section},
                                    {"stages", "Stages", stages_section}};
    return page_html({.inputs = inputs, .bodies = {}},
                     "<div class=\"verdict failed\"><strong>✗ Not built</strong><div>" +
                         html::escaped(message) + "</div></div>\n",
                     sections);
}

std::string thumbnail_png(const Case& patient_case) {
    const VirtualDisplay display;
    const PictureWindow window;
    return png_bytes(shrunk(
        scene_pictures(window, patient_case, {view_directions().front().direction}).front().picture, 4));
}

std::string html_report(const ReportInputs& inputs) {
    const VirtualDisplay display;
    const PictureWindow window;
    ReportPage page{.inputs = inputs, .bodies = {}, .window = &window};
    for (const DeformableBody& body : inputs.patient_case.deformable_bodies) {
        MeshSummary mesh = summarise(body.mesh);
        std::optional<AllowedLoadError> allowed;
        if (!inputs.allowed_load_errors.empty()) allowed = inputs.allowed_load_errors[page.bodies.size()];
        std::vector<Check> checks = checks_of(body, mesh, allowed);
        page.bodies.push_back({body, std::move(mesh), std::move(checks)});
    }
    return page_html(
        page,
        verdict(page.bodies) + cautions(inputs.patient_case.provenance) + key_figures(inputs, page.bodies),
        report_sections);
}

}  // namespace palpate::report
