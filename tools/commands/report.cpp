// SPDX-License-Identifier: GPL-3.0-or-later
// palpate report: what a case is made of and how good it is, on one page.
#include "tools/report/report.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <iterator>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/meshing/measures/surface_distance.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"
#include "tools/report/html.hpp"

namespace {

using namespace palpate;

std::string text_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream)
        throw InvalidInput({path.string(), "cannot be read", "", "check that it is a file you may read"});
    return text;
}

nlohmann::json json_of(const std::filesystem::path& path) {
    try {
        return nlohmann::json::parse(text_of(path));
    } catch (const nlohmann::json::parse_error& error) {
        throw InvalidInput({path.string(), error.what(), "JSON", "make it again with --json"});
    }
}

std::string svg_of(const std::filesystem::path& path) {
    std::string text = text_of(path);
    if (text.find("<svg") == std::string::npos)
        throw InvalidInput(
            {path.string(), "no <svg> in it", "a picture made by 'palpate touch --curve'", ""});
    return text;
}

SurfaceComparison comparison_of(const std::string& body, const TriangleMesh& surface,
                                const std::string& against, const TriangleMesh& reference) {
    const SurfaceDistance distance = surface_distance(surface, reference);
    return {body,
            against,
            triangle_distances(surface, reference),
            distance.mean,
            distance.percentile_95,
            distance.maximum,
            distance.farthest};
}

// "skull" or "skull,226": a body is the outline of its label or the grey isovalue around it.
struct RigidOrigin {
    std::string body, label;
    std::optional<double> isovalue;
};

RigidOrigin parse_origin(const std::string& text) {
    const auto equals = text.find('='), comma = text.find(',', equals == std::string::npos ? 0 : equals);
    RigidOrigin origin{text.substr(0, equals), "", {}};
    if (equals != std::string::npos) origin.label = text.substr(equals + 1, comma - equals - 1);
    double value = 0;
    const char* end = text.data() + text.size();
    if (comma != std::string::npos && std::from_chars(text.data() + comma + 1, end, value).ptr == end)
        origin.isovalue = value;
    if (origin.body.empty() || origin.label.empty() || (comma != std::string::npos && !origin.isovalue))
        throw UsageError({"--rigid " + text, "cannot be read", "BODY=LABEL or BODY=LABEL,ISOVALUE", ""});
    return origin;
}

// What `palpate surface` makes before it decimates.
TriangleMesh full_surface(const RigidOrigin& origin, const LabelMap& labels, const Volume* volume,
                          const std::string& culprit) {
    const std::array<std::int32_t, 1> value{require_label(labels, origin.label, culprit).value};
    constexpr std::int64_t min_triangles = 100;
    if (!origin.isovalue) return keep_large_pieces(label_surface(labels, value), min_triangles);
    if (volume == nullptr)
        throw UsageError(
            {"--rigid", "an isovalue needs --volume", "", "give the volume, or the label alone"});
    constexpr int mask_reach = 2;
    Volume masked = *volume;
    keep_near_labels(masked, labels, value, mask_reach);
    return keep_large_pieces(isosurface(masked, *origin.isovalue), min_triangles);
}

std::vector<SurfaceComparison> comparisons_of(const Case& patient_case, const LabelMap& labels,
                                              const Volume* volume, const std::vector<std::string>& origins,
                                              const std::string& culprit) {
    std::vector<SurfaceComparison> comparisons;
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        std::vector<std::int32_t> values;
        std::string names;
        for (const Label& region : body.mesh.region_names)
            if (const auto label = find_label(labels, region.name)) {
                values.push_back(label->value);
                names += (names.empty() ? "" : ", ") + region.name;
            }
        if (values.size() == body.mesh.region_names.size())
            comparisons.push_back(comparison_of(body.name, body.boundary.surface, "the outline of " + names,
                                                label_surface(labels, values)));
    }
    for (const std::string& text : origins) {
        const RigidOrigin origin = parse_origin(text);
        const auto body = std::ranges::find(patient_case.rigid_bodies, origin.body, &RigidBody::name);
        if (body == patient_case.rigid_bodies.end())
            throw InvalidInput(
                {"--rigid " + text, "the case has no such rigid body", "", "see 'palpate inspect'"});
        const TriangleMesh full = full_surface(origin, labels, volume, culprit);
        const std::string what = origin.isovalue ? fmt::format("the surface at {:g} HU", *origin.isovalue)
                                                 : "the outline of " + origin.label;
        comparisons.push_back(
            comparison_of(origin.body, body->surface,
                          what + ", " + html::grouped(std::ssize(full.triangles)) + " triangles", full));
    }
    return comparisons;
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "report",
         .summary = "Shows a case on one self-contained HTML page.",
         .examples =
             {"palpate report liver.vtkhdf --labels liver.seg.nrrd -o liver.html",
              "palpate report head.vtkhdf --volume head.nrrd --labels head.seg.nrrd --touch stats.json "
              "--curve force.svg -o head.html"},
         .notes =
             "Pictures are drawn on the display that DISPLAY names, without one on an Xvfb of its own."});
    std::filesystem::path asset, volume_path, labels_path, touch, curve, stages, output;
    std::vector<std::string> rigid;
    command.input("asset", asset, "case to report on (.vtkhdf)").required();
    command.input("--volume", volume_path, "volume to show slices of, any format of 'palpate import'");
    command.input("--labels", labels_path, "label map to show contours of (.seg.nrrd)");
    command.option(
        "--rigid", rigid,
        "BODY=LABEL or BODY=LABEL,ISOVALUE: what a rigid body was made from, to map its distance; repeat "
        "for more");
    command.input("--touch", touch, "statistics made by 'palpate touch --json'");
    command.input("--curve", curve, "force curve made by 'palpate touch --curve' (.svg)");
    command.input("--stages", stages, "stage times and peak memory made by 'palpate build' (.json)");
    command.output("-o,--output", output, "page to write (.html)").required();

    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile page = session.stage(output);
        set_imaging_threads(session.threads);
        session.progress.step("reading the case", 0);
        const Case patient_case = read_asset(asset);
        std::optional<Volume> volume;
        std::optional<LabelMap> labels;
        if (!volume_path.empty()) volume = read_volume(volume_path);
        if (!labels_path.empty()) labels = read_label_map(labels_path);
        ReportInputs inputs{.patient_case = patient_case,
                            .volume = volume ? &*volume : nullptr,
                            .labels = labels ? &*labels : nullptr};
        if (!rigid.empty() && !labels)
            throw UsageError({"--rigid", "needs --labels", "the label map that the body was made from", ""});
        if (labels) {
            session.progress.step("measuring distances", 0.1);
            inputs.comparisons =
                comparisons_of(patient_case, *labels, inputs.volume, rigid, labels_path.string());
        }
        if (!touch.empty()) inputs.touch = json_of(touch);
        if (!curve.empty()) inputs.force_curve_svg = svg_of(curve);
        if (!stages.empty()) inputs.stages = stages_from_json(json_of(stages), stages.string());
        session.progress.step("drawing", 0.3);
        const std::string html = html_report(inputs);
        page.write_text(html);
        page.commit();
        return nlohmann::json{{"report", output.string()}, {"bytes", html.size()}};
    });
}
