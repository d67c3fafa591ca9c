// SPDX-License-Identifier: GPL-3.0-or-later
#include <array>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/archive/objects/archive_objects.hpp"
#include "tools/archive/objects/segment_codes.hpp"
#include "tools/case_builder/folder_lock.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/outputs/staged_folder.hpp"
#include "tools/cli/refuse_beside.hpp"
#include "tools/cli/software.hpp"
#include "tools/cohort/bids/bids_export.hpp"
#include "tools/imaging/files/label_names.hpp"
#include "tools/inspection/file_kind.hpp"
#include "tools/stages/surface.hpp"

namespace {

using namespace palpate;
using namespace palpate::archive;

const cli::CommandText text{
    .name = "export",
    .summary =
        "Turns a label map or a closed surface into a DICOM object for a hospital's archive, a cohort "
        "into a BIDS dataset of derivatives.",
    .examples = {"palpate export labels.seg.nrrd --reference ct_series/ --identity -o labels.dcm",
                 "palpate export labels.seg.nrrd --label liver -o liver_stl.dcm"},
    .notes =
        "A label map becomes a DICOM Segmentation; a surface (.vtp, .vtk, .stl, .obj, .ply) or the outline "
        "of\n"
        "one label becomes an Encapsulated STL. Positions are LPS mm in both. Without --reference nothing\n"
        "leads to a patient: no name, id or date, and UIDs made from the content, so that equal input gives\n"
        "equal bytes. With it the object refers to study, series, slices and frame of reference of the "
        "series\n"
        "that it was made from, whose UIDs lead an archive's owner to the patient; with --identity it also "
        "has\n"
        "the patient's name, id, birth date and sex and the study's date, id and accession number, so that "
        "an\n"
        "archive files it there. Segments are numbered from 1 in the order of their values.\n"
        "The folder of a cohort that 'palpate batch' built from a BIDS dataset becomes a BIDS dataset of\n"
        "derivatives (OUTPUT bids/derivatives/palpate): structures (_dseg.nii.gz), asset and report of all\n"
        "patients that are built as their table and inputs are now. Inside the source dataset its files are\n"
        "named as sources; elsewhere by the dataset's DOI, if it has one."};

struct ExportRequest {
    std::filesystem::path input, output, reference;
    std::string label, label_names, title, series, unit = "mm", frame;
    std::string algorithm = "semiautomatic", algorithm_name = "palpate segment";
    bool identity = false;
};

nlohmann::ordered_json export_surface(const ExportRequest& request, const Filing& filing,
                                      const cli::StagedFile& staged, const imaging::NoteSink& note) {
    stages::SurfaceRequest wanted;
    wanted.output = request.output;
    wanted.unit = request.unit;
    wanted.frame = request.frame;
    if (request.label.empty()) {
        wanted.surface_file = request.input;
    } else {
        wanted.labels = request.input;
        wanted.label_names = {request.label};
        wanted.min_triangles = 0;
    }
    const stages::MadeSurface made = make_surface(
        wanted, [](std::string_view, double) {}, note);
    std::string title = request.title;
    if (title.empty()) title = request.label.empty() ? "surface" : request.label;
    write_surface_object(staged.path(), made.surface, title, filing, request.input.string());
    return {{"object", "encapsulated STL"},
            {"title", title},
            {"triangles", made.surface.triangles.size()},
            {"volume_mm3", made.quality.volume}};
}

nlohmann::ordered_json export_labels(const ExportRequest& request, const Filing& filing,
                                     const cli::StagedFile& staged, const imaging::NoteSink& note) {
    LabelMap map = imaging::read_label_map(request.input, note);
    if (!request.label_names.empty()) imaging::name_labels(map, request.label_names, note);
    const std::string culprit = request.input.string();
    map = along_reference(map, filing.reference ? &*filing.reference : nullptr, culprit);
    write_segmentation_object(staged.path(), map, filing, culprit);
    nlohmann::ordered_json segments = nlohmann::ordered_json::array();
    for (const Label& label : map.names) {
        const SegmentCodes codes = codes_of(label.name);
        segments.push_back({{"segment", segments.size() + 1},
                            {"value", label.value},
                            {"name", label.name},
                            {"code", codes.type.value},
                            {"meaning", codes.type.meaning}});
        if (!codes.known)
            note(fmt::format("no code is known for '{}': an anatomical structure, tissue", label.name));
    }
    return {{"object", "segmentation"}, {"segments", segments}};
}

nlohmann::ordered_json export_cohort(const ExportRequest& request, cli::Session& session) {
    const cohort::Cohort built = cohort::cohort_in(request.input);
    refuse_while_built(built.folder);
    const case_builder::FolderLock lock(built.folder.batch(), "batch");
    cohort::require_outside(request.output, built.folder.root);
    cli::end_softly_on_interrupt();
    cli::StagedFolder staged(request.output, session.force);
    cohort::require_replaceable(request.output);
    const auto step = [&](const char* what) {
        return [&session, what](double done) {
            if (cli::interrupt_asked()) throw cli::Interrupted();
            session.progress.step(what, done);
        };
    };
    imaging::set_imaging_threads(session.threads);
    const cohort::States states = states_of_all(built, cli::programs_folder(), step("comparing digests"));
    const cohort::BidsExport made =
        write_bids_dataset(built, states, request.output, staged.path(), step("writing"));
    staged.commit();
    session.progress.finish();
    nlohmann::ordered_json left_out = nlohmann::ordered_json::array();
    for (const auto& [patient, why] : made.left_out) {
        spdlog::warn("{} is left out: {}", patient, why);
        left_out.push_back({{"patient", patient}, {"said", why}});
    }
    if (!made.linked)
        spdlog::warn(
            "the dataset does not say which files it is from; write it into the source's "
            "derivatives/, or give the source a DatasetDOI");
    return {{"object", "BIDS derivatives"}, {"patients", made.patients}, {"left_out", left_out}};
}

nlohmann::ordered_json run_export(const ExportRequest& request, cli::Session& session) {
    if (request.identity && request.reference.empty())
        throw UsageError({"--identity", "is given without --reference", "both",
                          "name the folder of the series that the result was made from"});
    const inspection::FileKind kind = inspection::kind_of_file(request.input);
    if (kind != inspection::FileKind::image && kind != inspection::FileKind::surface)
        throw InvalidInput({request.input.string(), "is neither", "a label map or a closed surface",
                            "export the label map that it was made from"});
    if (!request.label.empty() && kind == inspection::FileKind::surface)
        throw UsageError({"--label", request.input.string() + " is a surface", "a label map", ""});
    cli::StagedFile staged = session.stage(request.output);
    const imaging::NoteSink note = [](std::string_view said) { spdlog::warn("{}", said); };
    imaging::set_imaging_threads(session.threads);
    Filing filing{.reference = std::nullopt,
                  .identity = request.identity,
                  .algorithm_type = request.algorithm,
                  .algorithm_name = request.algorithm_name,
                  .version = cli::version()};
    for (char& c : filing.algorithm_type) c = static_cast<char>(c - 'a' + 'A');
    if (!request.reference.empty()) {
        imaging::ReadOptions options;
        options.series = request.series;
        filing.reference = read_reference(request.reference, options, note);
    }
    const bool surface = kind == inspection::FileKind::surface || !request.label.empty();
    nlohmann::ordered_json result = surface ? export_surface(request, filing, staged, note)
                                            : export_labels(request, filing, staged, note);
    result["filed_beside"] = filing.reference ? "reference" : "nothing";
    result["identity"] = filing.identity;
    staged.commit();
    return result;
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(text);
    ExportRequest request;
    const cli::Option input_option =
        command
            .input("input", request.input,
                   "label map (.seg.nrrd, NIfTI, NRRD, DICOM SEG), closed surface, or folder of a cohort")
            .required();
    const cli::Option label =
        command.option("--label", request.label, "the outline of this label, by name or value, as a surface");
    command.option("--label-names", request.label_names, "names for the labels, as 'import' takes them")
        .excludes(label);
    command.option("--title", request.title, "of a surface; by default its label, or 'surface'");
    command.option("--unit", request.unit, "of a surface's file: um, mm, cm, m or in");
    command.option("--frame", request.frame,
                   "of a surface's file: lps or ras; by default what it states, else lps");
    command.option("--algorithm", request.algorithm, "how the labels came about")
        .one_of({"automatic", "semiautomatic", "manual"});
    command.option("--algorithm-name", request.algorithm_name, "what made the labels");
    const cli::Option reference =
        command.input("--reference", request.reference, "DICOM folder that the result was made from");
    command.option("--series", request.series, "of that folder, by number, UID or description")
        .needs(reference);
    command.flag("--identity", request.identity, "take the reference's patient and study along");
    const cli::Option output =
        command.output("-o,--output", request.output, "DICOM object (.dcm), or folder for a BIDS dataset")
            .required();
    return command.run(argc, argv, [&](cli::Session& session) {
        if (!std::filesystem::is_directory(request.input)) return run_export(request, session);
        refuse_beside(command, "a cohort", std::array{input_option, output},
                      "the others are for one label map or surface");
        return export_cohort(request, session);
    });
}
