// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fmt/format.h>

#include "tools/meshing/measures/quality.hpp"
#include "tools/report/html.hpp"
#include "tools/report/pictures/colour_scale.hpp"
#include "tools/report/sections.hpp"
#include "tools/report/view_svg.hpp"

namespace palpate::report {
namespace {

struct WorstElement {
    std::size_t tetrahedron;
    double sharpest, bluntest;  // degrees
    Eigen::Vector3d centroid;
    Label region;
};

// Those whose angles come nearest to 0 or 180 degrees.
std::vector<WorstElement> worst_of(const TetMesh& mesh) {
    std::vector<WorstElement> worst;
    for (const meshing::WorstTetrahedron& tet : meshing::measure(mesh).worst) {
        const auto t = static_cast<std::size_t>(tet.tetrahedron);
        const auto name = std::ranges::find(mesh.region_names, mesh.regions[t], &Label::value);
        worst.push_back(
            {t, tet.min_dihedral_deg, tet.max_dihedral_deg, tet.centroid,
             name != mesh.region_names.end() ? *name : Label{mesh.regions[t], "", {0.8F, 0.8F, 0.8F}}});
    }
    return worst;
}

std::string worst_of_body(const PictureWindow& window, const DeformableBody& body) {
    const std::vector<WorstElement> worst = worst_of(body.mesh);
    std::vector<std::size_t> tetrahedra;
    std::vector<std::string> numbers;
    std::vector<std::vector<std::string>> rows;
    std::string close_ups;
    for (const WorstElement& element : worst) {
        tetrahedra.push_back(element.tetrahedron);
        numbers.push_back(std::to_string(numbers.size() + 1));
        const Eigen::Vector3d& p = element.centroid;
        rows.push_back({numbers.back(), swatch(element.region), fmt::format("{:.1f}°", element.sharpest),
                        fmt::format("{:.1f}°", element.bluntest),
                        fmt::format("{:.1f}, {:.1f}, {:.1f}", p.x(), p.y(), p.z()),
                        html::grouped(static_cast<std::int64_t>(element.tetrahedron))});
        if (numbers.size() <= 3)
            close_ups +=
                html::figure(tetrahedron_svg(body.mesh, element.tetrahedron, element.region),
                             fmt::format("<b>Element {}</b>, the angle between the two faces at each edge",
                                         numbers.back()));
    }
    return figures_of(tetrahedra_pictures(window, body, tetrahedra, directions()), body.name, numbers) +
           html::table({{"", true},
                        {"Region"},
                        {"Sharpest angle", true},
                        {"Bluntest angle", true},
                        {"Centre L, P, S in mm", true},
                        {"Tetrahedron", true}},
                       rows) +
           "<div class=\"three\">\n" + close_ups + "</div>\n";
}

const TriangleMesh* surface_of(const Case& patient_case, const std::string& name) {
    for (const DeformableBody& body : patient_case.deformable_bodies)
        if (body.name == name) return &body.boundary.surface;
    for (const RigidBody& body : patient_case.rigid_bodies)
        if (body.name == name) return &body.surface;
    return nullptr;
}

}  // namespace

std::vector<ViewDirection> directions() {
    std::vector<ViewDirection> result;
    for (const NamedDirection& view : view_directions()) result.push_back(view.direction);
    return result;
}

std::string figures_of(const std::vector<SceneView>& views, const std::string& what,
                       const std::vector<std::string>& mark_names) {
    std::string figures;
    for (std::size_t i = 0; i < views.size(); ++i) {
        const NamedDirection& view = view_directions()[i];
        figures += html::figure(view_svg(views[i], view.direction, what + " " + view.words, mark_names),
                                "<b>" + html::escaped(what) + "</b> " + view.words);
    }
    return "<div class=\"two\">\n" + figures + "</div>\n";
}

std::string worst_section(const ReportPage& page) {
    const std::vector<MeasuredBody>& bodies = page.bodies;
    if (bodies.empty()) return "";
    std::string content;
    for (const MeasuredBody& measured : bodies)
        content += "<h3>" + html::escaped(measured.body.name) + "</h3>\n" +
                   worst_of_body(*page.window, measured.body);
    return html::section(
        "worst", "Worst elements",
        "The tetrahedra whose dihedral angles come nearest to 0° or 180°, ringed and solid in the "
        "glassy body. Flat elements are too stiff and spoil the forces around them.",
        content);
}

std::string distances_section(const ReportPage& page) {
    const ReportInputs& inputs = page.inputs;
    std::string content;
    std::vector<std::vector<std::string>> rows;
    const std::vector<SurfaceComparison> none;
    for (const SurfaceComparison& comparison : inputs.comparisons.valid() ? inputs.comparisons.get() : none) {
        const TriangleMesh* surface = surface_of(inputs.patient_case, comparison.body);
        if (surface == nullptr || surface->triangles.size() != comparison.triangle_distances.size()) continue;
        rows.push_back({html::escaped(comparison.body), html::escaped(comparison.against),
                        fmt::format("{:.3f}", comparison.mean),
                        fmt::format("{:.3f}", comparison.percentile_95),
                        fmt::format("{:.3f}", comparison.maximum)});
        constexpr double visible = 0.001;  // mm
        if (comparison.maximum < visible) continue;
        const ColourScale scale = scale_for(comparison.triangle_distances);
        content += "<h3>" + html::escaped(comparison.body) + " against " + html::escaped(comparison.against) +
                   "</h3>\n" +
                   figures_of(coloured_pictures(*page.window, *surface, comparison.triangle_distances, scale,
                                                comparison.farthest, directions()),
                              comparison.body, {fmt::format("{:.2f} mm", comparison.maximum)}) +
                   "<figure>" + scale_svg(scale, "mm") + "</figure>\n";
    }
    if (rows.empty())
        return html::section(
            "distances", "Distances", "",
            html::missing(inputs.labels
                              ? "No body has the name of a label, so there is nothing to compare with."
                              : "No label map was given; <code>--labels labels.seg.nrrd</code> adds how "
                                "far each surface is from its label."));
    return html::section(
        "distances", "Distances",
        "How far the surface that is touched lies from the one that it stands for, triangle by "
        "triangle. The ring is the farthest place; it may lie behind what is seen.",
        html::table({{"Body"}, {"Against"}, {"Mean, mm", true}, {"95 %, mm", true}, {"Most, mm", true}},
                    rows) +
            content);
}

}  // namespace palpate::report
