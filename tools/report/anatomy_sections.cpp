// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <map>

#include "tools/report/html.hpp"
#include "tools/report/pictures/scene.hpp"
#include "tools/report/pictures/slice_targets.hpp"
#include "tools/report/pictures/slices.hpp"
#include "tools/report/sections.hpp"
#include "tools/report/view_svg.hpp"

namespace palpate::report {
namespace {

using Eigen::Vector3d;

Eigen::AlignedBox3d box_of(const std::vector<Vector3d>& points) {
    Eigen::AlignedBox3d box;
    for (const Vector3d& p : points) box.extend(p);
    return box;
}

double side_for(const Eigen::AlignedBox3d& box) {
    return box.sizes().maxCoeff() + 2 * std::max(20.0, 0.15 * box.sizes().maxCoeff());
}

// The centroid of the smallest region: in an organ with a tumour, the tumour.
std::pair<std::string, Vector3d> smallest_region(const TetMesh& mesh) {
    std::map<std::int32_t, std::pair<double, Vector3d>> regions;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        Vector3d sum = Vector3d::Zero();
        for (const std::int32_t node : mesh.tetrahedra[t]) sum += mesh.rest_positions[node];
        auto& [volume, moment] = regions.try_emplace(mesh.regions[t], 0.0, Vector3d::Zero()).first->second;
        volume += six_volume(mesh, t);
        moment += six_volume(mesh, t) * sum / 4;
    }
    const auto smallest =
        std::ranges::min_element(regions, {}, [](const auto& region) { return region.second.first; });
    const auto name = std::ranges::find(mesh.region_names, smallest->first, &Label::value);
    return {name != mesh.region_names.end() ? name->name : std::to_string(smallest->first),
            smallest->second.second / smallest->second.first};
}

SliceTarget target_of(const ReportInputs& inputs) {
    const Case& c = inputs.patient_case;
    if (!c.deformable_bodies.empty()) {
        const DeformableBody& body = c.deformable_bodies.front();
        const auto [region, planes] = smallest_region(body.mesh);
        const auto box = box_of(body.mesh.rest_positions);
        return {planes, box.center(), side_for(box),
                region == body.name ? region : region + " of " + body.name};
    }
    if (!c.rigid_bodies.empty()) {
        const auto box = box_of(c.rigid_bodies.front().surface.vertices);
        return {box.center(), box.center(), side_for(box), c.rigid_bodies.front().name};
    }
    const ImageGrid& grid = inputs.volume ? inputs.volume->grid : inputs.labels->grid;
    const Vector3d last(grid.size[0] - 1, grid.size[1] - 1, grid.size[2] - 1);
    return {grid.point_of(last / 2), grid.point_of(last / 2), grid.spacing.cwiseProduct(last).maxCoeff(),
            "the image"};
}

std::string outline_path(const SliceWindow& window, const TriangleMesh& surface) {
    std::string path;
    for (const auto& [a, b] : slice_outline(window, surface))
        path += fmt::format("M{:.1f} {:.1f}L{:.1f} {:.1f}", a.x(), a.y(), b.x(), b.y());
    return path.empty() ? "" : fmt::format("<path class=\"outline\" d=\"{}\"/>", path);
}

std::string slice_svg(const ReportInputs& inputs, const SliceWindow& window) {
    const PlaneText text = plane_text(window.plane);
    const int n = window.pixels;
    std::string svg = fmt::format(
        "<svg class=\"slice\" viewBox=\"0 0 {0} {0}\" role=\"img\" aria-label=\"{1} slice\">"
        "<image width=\"{0}\" height=\"{0}\" href=\"{2}\"/>",
        n, text.title,
        html::data_uri("image/png", png_bytes(slice_picture(window, inputs.volume, inputs.labels))));
    for (const DeformableBody& body : inputs.patient_case.deformable_bodies)
        svg += outline_path(window, body.boundary.surface);
    for (const RigidBody& body : inputs.patient_case.rigid_bodies) svg += outline_path(window, body.surface);
    const auto letter = [&](int x, int y, const std::string& what) {
        svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">{}</text>", x, y, what);
    };
    letter(16, n / 2 + 7, text.left);
    letter(n - 16, n / 2 + 7, text.right);
    letter(n / 2, 26, text.top);
    letter(n / 2, n - 12, text.bottom);
    const double length = scale_bar_length(window.side);
    svg += fmt::format(
        "<path class=\"scale\" d=\"M20 {0}h{1:.1f}\"/><text class=\"small\" x=\"20\" y=\"{2}\">{3:g} "
        "mm</text></svg>",
        n - 20, length * n / window.side, n - 30, length);
    return svg;
}

std::string legend(const ReportInputs& inputs) {
    std::string items;
    if (inputs.labels)
        for (const Label& label : inputs.labels->names)
            if (std::ranges::find(inputs.labels->labels, label.value) != inputs.labels->labels.end())
                items += "<li>" + swatch(label) + "</li>";
    items += "<li><span class=\"dash\"></span>surface of a body’s mesh</li>";
    return "<ul class=\"legend\">" + items + "</ul>\n";
}

// Three planes through a target, side by side.
std::string three_planes(const ReportInputs& inputs, const SliceTarget& target) {
    std::string figures;
    for (const Plane plane : {Plane::axial, Plane::coronal, Plane::sagittal}) {
        const PlaneText text = plane_text(plane);
        SliceWindow window{.plane = plane, .center = target.center, .side = target.side};
        const double at = window.center[text.axis] = target.planes[text.axis];
        figures += html::figure(slice_svg(inputs, window),
                                fmt::format("<b>{}</b>, {} = {:.1f} mm", text.title, text.higher, at));
    }
    return "<div class=\"three\">\n" + figures + "</div>\n";
}

// Every structure in planes of its own, the first ones if there are many.
std::string structures(const ReportInputs& inputs) {
    constexpr std::size_t most = 8;
    std::vector<SliceTarget> targets = label_targets(*inputs.labels);
    std::string content;
    if (targets.size() > most)
        content = fmt::format("<p class=\"lead\">The first {} of {} structures are shown.</p>\n", most,
                              targets.size());
    targets.resize(std::min(targets.size(), most));
    for (const SliceTarget& target : targets)
        content += "<h3>" + html::escaped(target.name) + "</h3>\n" + three_planes(inputs, target);
    return content;
}

}  // namespace

std::string swatch(const Label& label) {
    return fmt::format("<span class=\"swatch\" style=\"background:rgb({},{},{})\"></span>{}",
                       std::lround(255 * label.colour[0]), std::lround(255 * label.colour[1]),
                       std::lround(255 * label.colour[2]), html::escaped(label.name));
}

std::string slices_section(const ReportPage& page) {
    const ReportInputs& inputs = page.inputs;
    std::string lead, content;
    if (!inputs.volume && !inputs.labels) {
        content = html::missing(
            "No image was given. <code>--volume volume.nrrd</code> adds the slices, "
            "<code>--labels labels.seg.nrrd</code> the contours.");
        return html::section("slices", "Slices", lead, content);
    }
    const SliceTarget target = target_of(inputs);
    lead = fmt::format("Three planes through {}. Radiological display: the patient’s right is at the left.",
                       html::escaped(target.name));
    if (inputs.volume) {
        const GreyWindow grey = grey_window(*inputs.volume);
        lead += fmt::format(" Grey runs from {:.4g} to {:.4g}{}.", grey.black, grey.white,
                            grey.hounsfield ? " HU" : "");
    } else {
        lead +=
            " No volume was given, so labels stand on plain grey; <code>--volume volume.nrrd</code> adds it.";
    }
    if (!inputs.labels)
        lead += " No label map was given; <code>--labels labels.seg.nrrd</code> adds the contours.";
    content = three_planes(inputs, target) + legend(inputs);
    if (inputs.labels) content += structures(inputs);
    return html::section("slices", "Slices", lead, content);
}

const std::vector<NamedDirection>& view_directions() {
    static const std::vector<NamedDirection> directions{
        {{-0.7, -1, 0.45}, "from the patient’s right, front and above"},
        {{0.85, 0.75, 0.4}, "from the patient’s left, back and above"}};
    return directions;
}

std::string bodies_section(const ReportPage& page) {
    const Case& patient_case = page.inputs.patient_case;
    std::vector<ViewDirection> directions;
    for (const NamedDirection& view : view_directions()) directions.push_back(view.direction);
    const auto side_by_side = [&](const std::vector<SceneView>& views, const std::string& name) {
        std::string figures;
        for (std::size_t i = 0; i < views.size(); ++i) {
            const auto& [direction, words] = view_directions()[i];
            figures += html::figure(view_svg(views[i], direction, name + " " + words),
                                    "<b>" + html::escaped(name) + "</b> " + words);
        }
        return "<div class=\"two\">\n" + figures + "</div>\n";
    };
    std::string content = side_by_side(scene_pictures(*page.window, patient_case, directions), "All bodies");
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        std::string regions;
        for (const Label& label : body.mesh.region_names) regions += "<li>" + swatch(label) + "</li>";
        content += side_by_side(body_pictures(*page.window, body, directions), body.name) +
                   "<ul class=\"legend\">" + regions +
                   "<li><span class=\"dot\"></span>fixed node</li><li><span class=\"swatch\" "
                   "style=\"background:#9ea8b2\"></span>surface that cannot be touched</li></ul>\n";
    }
    return html::section("bodies", "Bodies in three dimensions",
                         "Rigid bodies are bone-coloured glass. Of a deformable body the outer region is "
                         "translucent, so that what it encloses shows.",
                         content);
}

}  // namespace palpate::report
