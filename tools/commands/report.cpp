// SPDX-License-Identifier: GPL-3.0-or-later
// palpate report: what a case is made of and how good it is, on one page.
#include "tools/report/report.hpp"

#include <fstream>
#include <iterator>

#include "formats/asset/asset.hpp"
#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/imaging/image_files.hpp"

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
    command.input("asset", asset, "case to report on (.vtkhdf)")->required();
    command.input("--volume", volume_path, "volume to show slices of, any format of 'palpate import'");
    command.input("--labels", labels_path, "label map to show contours of (.seg.nrrd)");
    command.input("--touch", touch, "statistics made by 'palpate touch --json'");
    command.input("--curve", curve, "force curve made by 'palpate touch --curve' (.svg)");
    command.input("--stages", stages, "stage times and peak memory made by 'palpate build' (.json)");
    command.output("-o,--output", output, "page to write (.html)")->required();

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
