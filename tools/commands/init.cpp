// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "formats/toml_file/quoted.hpp"
#include "tools/case_builder/checks/case_check.hpp"
#include "tools/case_builder/child_process.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/software.hpp"
#include "tools/commands/init/questions.hpp"
#include "tools/commands/init/request.hpp"
#include "tools/draft/anatomy.hpp"
#include "tools/draft/case_draft.hpp"
#include "tools/draft/scan_draft.hpp"
#include "tools/imaging/faces/face.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/files/label_names.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/labels/voxelised.hpp"
#include "tools/meshing/measures/quality.hpp"

namespace {
using namespace palpate;
using namespace palpate::imaging;
using namespace palpate::commands;
namespace fs = std::filesystem;

const NoteSink warn = [](std::string_view said) { spdlog::warn("{}", said); };

// How the case file, which will lie beside `output`, names a file.
std::string path_from(const fs::path& output, const fs::path& file) {
    const fs::path folder = fs::absolute(output).parent_path();
    return toml_file::quoted(fs::absolute(file).lexically_proximate(folder).string());
}

std::string import_lines(const std::string& label, const std::string& cleaning) {
    return fmt::format("recipe = \"import\"\nlabel = {}\n{}", toml_file::quoted(label), cleaning);
}

draft::CaseDraft draft_of_labels(InitRequest& request, LabelMap map, cli::Questions& questions) {
    name_labels(map, request.label_names, warn);
    ask_organ(request, map, questions);
    ask_approach(request, questions);
    ask_size(request, questions);
    draft::CaseDraft found =
        draft_case(std::move(map), wishes_of(request), request.input.filename().string());
    found.input = fmt::format("labels = {}\n", path_from(request.output, request.input));
    if (!request.label_names.empty())
        found.input += fmt::format("label_names = {}\n", fs::is_regular_file(request.label_names)
                                                             ? path_from(request.output, request.label_names)
                                                             : toml_file::quoted(request.label_names));
    for (draft::DraftStructure& structure : found.structures)
        structure.recipe = import_lines(
            structure.name,
            structure.name == found.name ? "close_mm = 3.0\nfill_holes = true\nkeep_largest = true\n" : "");
    return found;
}

bool ends_with_one_of(const fs::path& file, std::span<const char* const> endings) {
    std::string ending = file.extension().string();
    std::ranges::transform(ending, ending.begin(),
                           [](unsigned char c) { return static_cast<char>(std::tolower(c)); });
    return std::ranges::find(endings, ending) != endings.end();
}

bool is_mesh(const fs::path& file) {
    return ends_with_one_of(file, std::array{".msh", ".mesh", ".vtu"});
}

bool is_surface(const fs::path& file) {
    return ends_with_one_of(file, std::array{".stl", ".obj", ".ply", ".vtp"});
}

template <typename Points>
double largest_extent(const Points& points) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : points) box.extend(p);
    return box.sizes().maxCoeff();
}

// What a surface encloses becomes a label map beside the case file, fine enough to keep its shape.
draft::CaseDraft draft_of_surface(InitRequest& request, cli::Questions& questions, cli::Session& session) {
    constexpr double voxels_across = 160;
    meshing::ImportedMeshOptions options;
    options.unit =
        draft::plausible_unit(largest_extent(read_unrepaired_surface(request.input, options).vertices));
    const TriangleMesh surface = read_imported_surface(request.input, options, warn);
    ask_name(request, questions);
    const double spacing =
        std::max(0.1, std::round(10 * largest_extent(surface.vertices) / voxels_across) / 10);
    LabelMap map = meshing::voxelised(surface, request.organ, spacing);
    const double whole_ml =
        static_cast<double>(std::ranges::count(map.labels, 1)) * spacing * spacing * spacing / 1000;
    const fs::path labels = fs::path(request.output).replace_extension(".seg.nrrd");
    cli::StagedFile staged = session.stage(labels);
    write_label_map(staged.path(), map);
    spdlog::info("{}: what it encloses, in voxels of {:g} mm, is in {}", request.input.string(), spacing,
                 labels.string());
    InitRequest of_labels = request;
    of_labels.input = labels;
    draft::CaseDraft found = draft_of_labels(of_labels, std::move(map), questions);
    request.approach = of_labels.approach;
    request.size_mib = of_labels.size_mib;
    found.structures.front().recipe = import_lines(found.name, "keep_largest = true\n");
    if (found.volume_ml < 0.99 * whole_ml)
        spdlog::warn("{}: of its several pieces the largest is taken, {:.1f} of {:.1f} ml", labels.string(),
                     found.volume_ml, whole_ml);
    staged.commit();
    return found;
}

// The contract asks of an imported mesh what it has: nobody will make it finer.
draft::CaseDraft draft_of_mesh(InitRequest& request, cli::Questions& questions) {
    ask_approach(request, questions);
    meshing::ImportedMeshOptions options;
    const TetMesh as_numbered = read_imported_tetrahedra(request.input, options);
    options.unit = draft::plausible_unit(largest_extent(as_numbered.rest_positions));
    const TetMesh mesh = read_imported_tetrahedra(request.input, options, warn);
    draft::CaseDraft found = draft_case(
        mesh, wishes_of(request), request.organ.empty() ? request.input.stem().string() : request.organ);
    found.mesh = fmt::format(
        "mesh_file = {}\n# The file does not say its unit; in this one it is as large as organs are.\n"
        "mesh_unit = \"{}\"\n",
        path_from(request.output, request.input), options.unit);
    const meshing::MeshQuality quality = meshing::measure(mesh);
    found.quality =
        fmt::format("# What this mesh has.\n[quality]\nmin_dihedral_deg = {:g}\nmax_dihedral_deg = {:g}\n",
                    std::floor(quality.min_dihedral_deg), std::ceil(quality.max_dihedral_deg));
    return found;
}

// Seeds in a window, which shows what the case will make of them; what was saved before is taken.
void click_seeds(InitRequest& request, const draft::ScanRecipes& recipes) {
    if (std::getenv("DISPLAY") == nullptr)
        throw UsageError({"--seed", "none given, and there is no display to click one",
                          "a point x,y,z (LPS, mm) in " + recipes.where,
                          "or --seeds-file with points of 3D Slicer or 'palpate seeds'"});
    request.seeds_file = fs::path(request.output).replace_extension(".mrk.json");
    if (fs::exists(request.seeds_file)) {
        spdlog::info("seeds of {} are taken; remove it to place others", request.seeds_file.string());
        return;
    }
    spdlog::info("click into {}; save with S, leave with Q", recipes.where);
    const fs::path program = cli::programs_folder() / "palpate-seeds";
    std::vector<std::string> arguments{request.input.string(), "-o", request.seeds_file.string()};
    for (const std::string& structure : recipes.structures)
        if (structure.starts_with(recipes.clicked + ":"))
            arguments.insert(arguments.end(),
                             {"--structure", draft::with_points(structure, {}, request.background_seeds)});
    if (!request.series.empty()) arguments.insert(arguments.end(), {"--series", request.series});
    if (request.scale)
        arguments.insert(arguments.end(), {fmt::format("--scale={:g}", *request.scale),
                                           fmt::format("--offset={:g}", request.offset)});
    const auto child = case_builder::run_child(program, arguments);
    if (child.exit_code != 0 || !fs::exists(request.seeds_file))
        throw InvalidInput({request.seeds_file.string(), "no seeds were saved", "one at least",
                            "run again and save with S, or give --seed"});
}

// A structure grown in the scan, as the case will grow it.
draft::CaseDraft draft_of_volume(InitRequest& request, Volume volume, cli::Questions& questions,
                                 cli::Session& session) {
    if (request.scale) rescale(volume, {*request.scale, request.offset});
    const bool ct = is_ct(volume);
    ask_organ(request, volume, ct, questions);
    ask_approach(request, questions);
    ask_size(request, questions);
    if (request.seeds.empty() && request.seeds_file.empty()) {
        const draft::ScanRecipes recipes = draft::scan_recipes(
            request.organ, ct, !request.background_seeds.empty(), Eigen::Vector3d::Zero());
        ask_seed(request, recipes, questions);
        if (request.seeds.empty()) click_seeds(request, recipes);
    }
    const draft::ScanSeeds seeds{
        request.seeds, request.background_seeds, request.seeds_file,
        request.seeds_file.empty() ? "" : path_from(request.output, request.seeds_file)};
    draft::CaseDraft found = draft::draft_scan(
        volume, ct, seeds, wishes_of(request), request.input.filename().string(),
        [&](std::string_view name, double done) {
            session.progress.step(fmt::format("finding {}", name), 0.2 + 0.6 * done);
        },
        warn);
    found.input = fmt::format("volume = {}\n", path_from(request.output, request.input));
    if (!request.series.empty())
        found.input += fmt::format("series = {}\n", toml_file::quoted(request.series));
    if (request.scale)
        found.input += fmt::format(
            "# HU = scale x value + offset{}.\nscale = {:g}\noffset = {:g}\n",
            request.scale_is_guessed ? ", guessed by air and soft tissue to some 4 %: correct it if you know"
                                     : "",
            *request.scale, request.offset);
    return found;
}

void refuse_scale(const InitRequest& request, const char* what) {
    if (request.scale)
        throw UsageError({"--scale", std::string("given with ") + what, "a CT", "leave it out"});
}

draft::CaseDraft draft_of(InitRequest& request, cli::Questions& questions, cli::Session& session) {
    wishes_of(request);  // which refuses what makes no sense before anything is read
    session.progress.step("reading", 0);
    if (is_mesh(request.input) || is_surface(request.input)) refuse_scale(request, "no image");
    if (is_mesh(request.input)) return draft_of_mesh(request, questions);
    if (is_surface(request.input)) return draft_of_surface(request, questions, session);
    ask_series(request, questions);
    const std::string name = request.input.filename().string();
    const bool labels = request.labels || name.ends_with(".seg.nrrd") || !request.label_names.empty();
    ReadOptions options;
    options.series = request.series;
    FoundImage found =
        read_image(request.input, labels ? ImageKind::labels : ImageKind::found_out, warn, options);
    if (auto* map = std::get_if<LabelMap>(&found.image)) {
        refuse_scale(request, "a label map");
        return draft_of_labels(request, std::move(*map), questions);
    }
    auto& volume = std::get<Volume>(found.image);
    if (found.modality.empty()) ask_scale(request, volume, questions);  // others say what they are
    return draft_of_volume(request, std::move(volume), questions, session);
}

// What is asked of an input that has no such thing, or cannot be written into a case.
void check(const InitRequest& request) {
    check_name(request.organ);
    for (const auto& [option, points] :
         {std::pair("--seed", &request.seeds), std::pair("--background-seed", &request.background_seeds)})
        for (const std::string& point : *points) draft::check_point(point, option);
    if (is_surface(request.input) && !(request.label_names.empty() && request.seeds.empty()))
        throw UsageError({request.label_names.empty() ? "--seed" : "--label-names",
                          "given with a surface, which encloses one organ", "", "leave it out"});
}

nlohmann::ordered_json run_init(InitRequest request, cli::Session& session) {
    check(request);
    if (request.output.extension() != ".toml")
        throw UsageError({"--output", request.output.string(), "a name that ends in .toml", ""});
    cli::seekable_target(request.output);  // the case is read again, to check it
    set_imaging_threads(session.threads);
    cli::StagedFile staged = session.stage(request.output);
    cli::Questions questions(session, request.yes);
    draft::CaseDraft found = draft_of(request, questions, session);
    if (request.size_mib > 0)
        found.mesh += fmt::format(
            "# What the compliance may take in the file: compressed where all of it takes more.\n"
            "compliance = {{ size_mib = {:g} }}\n",
            request.size_mib);
    staged.write_text(draft::case_text(found));
    staged.commit();
    case_builder::check_case_file(request.output, case_builder::read_case_file(request.output));
    const std::string asset = fs::path(request.output).replace_extension(".vtkhdf").string();
    session.text = fmt::format(
        "{}: '{}', {:.0f} ml, cells of {:.1f} mm, held at {}; {} neighbours\n"
        "Look at it, then: palpate build {} -o {}\n",
        request.output.string(), found.name, found.volume_ml, found.cell_size, found.why_held,
        found.rigid.size(), request.output.string(), asset);
    if (questions.asks())
        session.text += fmt::format("The same without questions: {}\n", command_of(request));
    nlohmann::ordered_json regions = nlohmann::ordered_json::array(), rigid = nlohmann::ordered_json::array();
    for (const draft::DraftRigid& body : found.rigid) rigid.push_back(body.label);
    for (const draft::DraftRegion& region : found.regions)
        regions.push_back({{"label", region.label}, {"tissue", region.tissue}});
    return {{"case", request.output.string()},
            {"organ", found.name},
            {"volume_ml", found.volume_ml},
            {"cell_size_mm", found.cell_size},
            {"held", found.why_held},
            {"regions", regions},
            {"rigid", rigid}};
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "init",
         .summary =
             "Drafts a case file that builds at once, from a scan, a label map, tetrahedra or a surface",
         .examples = {"palpate init totalseg.nii.gz --organ liver -o liver.toml",
                      "palpate init ct_series/ --organ liver --seed -30,-8,-4 -o liver.toml",
                      "palpate init head_ct.nrrd --organ nasopharynx --seed 0,-5,-40 -o nasopharynx.toml",
                      "palpate init mri.nii.gz --organ brain -o brain.toml",
                      "palpate init prostate.stl -o prostate.toml"},
         .notes =
             "A label map (any that 'palpate import --labels' reads; TotalSegmentator's names are "
             "known) gives the organ,\n"
             "its lesions and its neighbours. In a CT the liver is found from a seed in it or three, "
             "the nasopharynx from\n"
             "one in the air behind the nose; any other solid organ, and a brain in MRI, from seeds in "
             "it or, where that\n"
             "leaks, against seeds around it (--background-seed, or points of 'background' in a file). "
             "Without seeds the\n"
             "window of 'palpate seeds' opens where there is a display, and shows what the case will "
             "make of them.\n"
             "On a terminal it asks what no option says, with a proposal for each answer; --yes takes them "
             "all. Elsewhere\n"
             "it asks nothing.\n"
             "Tetrahedra keep their regions; what a closed surface encloses becomes a label map beside "
             "the case file; both\n"
             "in the unit in which they are as large as organs. The file says why each thing is as it "
             "is; edit it and\n"
             "build."});
    InitRequest request;
    command
        .input("input", request.input,
               "label map, CT or MRI volume, DICOM folder, tetrahedra (.msh, .mesh, .vtu) or closed surface "
               "(.stl, .obj, .ply, .vtp)")
        .required();
    command.option("--organ", request.organ,
                   "what gives way: a label, or any name in a scan; without it the largest label of known "
                   "tissue, in a CT the liver or a head's nasopharynx");
    command.flag("--labels", request.labels,
                 "the input is a label map, as DICOM SEG is; found out without it");
    command.option("--label-names", request.label_names, "names of labels, as 'palpate import' takes them");
    command.option("--series", request.series, "of a DICOM folder with several");
    const cli::Option scale = command
                                  .option("--scale", request.scale,
                                          "of a CT whose values are no HU, as in 8 bit: HU = SCALE x value + "
                                          "OFFSET; without it air and soft "
                                          "tissue tell, where they do")
                                  .positive();
    command.option("--offset", request.offset, "see --scale", "HU").needs(scale);
    command.option("--seed", request.seeds, "a point x,y,z inside the organ (LPS, mm); repeat for more")
        .one_value_each();
    command
        .option("--background-seed", request.background_seeds,
                "a point x,y,z outside the organ; repeat for more")
        .one_value_each();
    command.input("--seeds-file", request.seeds_file, "points of 3D Slicer or 'palpate seeds'");
    command
        .option("--approach", request.approach,
                "side that the tool comes from: anterior, posterior, left, right, superior, inferior")
        .shown_default("anterior");
    const cli::Option nodes = command
                                  .option("--contact-nodes", request.contact_nodes,
                                          "surface nodes that the mesh should have, about")
                                  .positive()
                                  .shown_default(fmt::format("{:g}", draft::Wishes{}.contact_nodes));
    command
        .option(
            "--size-mib", request.size_mib,
            "what the compliance, most of an asset, may take: the mesh is about as fine as that allows, and "
            "the compliance is compressed where it takes more; 0: as --contact-nodes has it",
            "MiB")
        .range(0.0, 100'000.0)
        .excludes(nodes);
    command.flag("--yes", request.yes, "ask nothing on a terminal: take what is proposed");
    command.output("-o,--output", request.output, "case file (.toml)").required();
    return command.run(argc, argv, [&](cli::Session& session) { return run_init(request, session); });
}
