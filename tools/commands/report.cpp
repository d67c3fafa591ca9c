// SPDX-License-Identifier: GPL-3.0-or-later
// palpate report: what a case is made of and how good it is, on one page.
#include "tools/report/report.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <future>
#include <iterator>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/fem/certificate/certificate.hpp"
#include "tools/fem/certificate/contact_loads.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/files/shallow_json.hpp"
#include "tools/meshing/measures/surface_distance.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"
#include "tools/report/html.hpp"
#include "tools/report/pictures/virtual_display.hpp"
#include "tools/stages/requests/report_request.hpp"
#include "tools/stages/surface.hpp"

namespace {

using namespace palpate;
using namespace palpate::imaging;
using namespace palpate::meshing;
using namespace palpate::report;

std::string text_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    std::string text{std::istreambuf_iterator<char>(stream), {}};
    if (!stream)
        throw InvalidInput({path.string(), "cannot be read", "", "check that it is a file you may read"});
    return text;
}

nlohmann::json json_of(const std::filesystem::path& path) {
    const nlohmann::json document = read_json_file(path);
    if (document.is_discarded())
        throw InvalidInput({path.string(), "is no JSON, or nested more than 32 deep",
                            "what --json of a command wrote", "make it again with --json"});
    return document;
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
    TriangleDistances distances = triangle_distances(surface, reference);
    const SurfaceDistance& whole = distances.whole;
    return {body,          against,       std::move(distances.of_triangle), whole.mean, whole.percentile_95,
            whole.maximum, whole.farthest};
}

// The rigid body's surface against what `palpate surface` made of the same origin before it decimated.
SurfaceComparison comparison_of(const stages::RigidOrigin& origin, const Case& patient_case,
                                const LabelMap& labels, const std::optional<Volume>& volume,
                                const std::filesystem::path& labels_path) {
    const auto body = std::ranges::find(patient_case.rigid_bodies, origin.body, &RigidBody::name);
    if (body == patient_case.rigid_bodies.end())
        throw InvalidInput({"--rigid " + origin.body + "=" + origin.label, "the case has no such rigid body",
                            "", "see 'palpate inspect'"});
    if (origin.isovalue && !volume)
        throw UsageError(
            {"--rigid", "an isovalue needs --volume", "", "give the volume, or the label alone"});
    stages::SurfaceRequest request;
    request.labels = labels_path;
    request.label_names = {origin.label};
    request.isovalue = origin.isovalue;
    const TriangleMesh full = full_surface(request, labels, origin.isovalue ? volume : std::nullopt);
    const std::string what = origin.isovalue ? fmt::format("the surface at {:g} HU", *origin.isovalue)
                                             : "the outline of " + origin.label;
    return comparison_of(origin.body, body->surface,
                         what + ", " + html::grouped(std::ssize(full.triangles)) + " triangles", full);
}

std::vector<SurfaceComparison> comparisons_of(const stages::ReportRequest& request, const Case& patient_case,
                                              const LabelMap& labels, const std::optional<Volume>& volume) {
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
    for (const stages::RigidOrigin& origin : request.rigid)
        comparisons.push_back(comparison_of(origin, patient_case, labels, volume, request.labels));
    return comparisons;
}

Case case_of(const stages::ReportRequest& request) {
    if (!request.asset.empty()) return asset::read_asset(request.asset);
    Case patient_case;
    patient_case.name = request.name.empty() ? request.failed_with.stem().string() : request.name;
    return patient_case;
}

std::string page_of(const stages::ReportRequest& request, const Case& patient_case, cli::Session& session) {
    const bool failed = request.asset.empty();
    std::optional<Volume> volume;
    std::optional<LabelMap> labels;
    if (!request.volume.empty()) volume = read_volume(request.volume);
    if (!request.labels.empty()) labels = read_label_map(request.labels);
    ReportInputs inputs{.patient_case = patient_case,
                        .volume = volume ? &*volume : nullptr,
                        .labels = labels ? &*labels : nullptr};
    if (!request.rigid.empty() && !labels)
        throw UsageError({"--rigid", "needs --labels", "the label map that the body was made from", ""});
    if (labels && !failed)
        inputs.comparisons =
            std::async(session.threads > 1 ? std::launch::async : std::launch::deferred, [&] {
                return comparisons_of(request, patient_case, *labels, volume);
            }).share();
    if (!request.touch.empty()) inputs.touch = json_of(request.touch);
    if (!request.curve.empty()) inputs.force_curve_svg = svg_of(request.curve);
    if (!request.stages.empty())
        inputs.stages = stages_from_json(json_of(request.stages), request.stages.string());
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        const fem::LoadError allowed =
            fem::allowed_load_error(body, {body.certificate.load_error, body.certificate.contact_error},
                                    fem::certificate_loads, fem::certificate_seed);
        inputs.allowed_load_errors.push_back({allowed.surface, allowed.contact});
    }
    session.progress.step("measuring and drawing", 0.1);
    return failed ? html_failure(inputs, text_of(request.failed_with)) : html_report(inputs);
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
    stages::ReportRequest request;
    declare(command, request);
    return command.run(argc, argv, [&](cli::Session& session) {
        if (request.asset.empty() == request.failed_with.empty())
            throw UsageError({"asset", "is given with --failed-with, or neither is", "one of them", ""});
        if (!request.thumbnail.empty() && request.asset.empty())
            throw UsageError({"--thumbnail", "needs a case to picture", "an asset", ""});
        cli::StagedFile page = session.stage(request.output);
        std::optional<VirtualDisplay> display;  // one for all that is drawn
        if (!request.asset.empty()) display.emplace();
        set_imaging_threads(session.threads);
        session.progress.step("reading the case", 0);
        const Case patient_case = case_of(request);
        const std::string html = page_of(request, patient_case, session);
        if (!request.thumbnail.empty())
            cli::write_text_file(request.thumbnail, thumbnail_png(patient_case), session.force);
        page.write_text(html);
        page.commit();
        return nlohmann::json{{"report", request.output.filename().string()}, {"bytes", html.size()}};
    });
}
