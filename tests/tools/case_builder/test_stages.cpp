// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <unistd.h>

#include "tests/tools/refusal_of.hpp"
#include "tools/case_builder/stages.hpp"

namespace palpate::case_builder {
namespace {

using namespace case_builder;

namespace fs = std::filesystem;

nlohmann::ordered_json request_of(const std::vector<Stage>& stages, const std::string& name) {
    const auto stage = std::ranges::find(stages, name, &Stage::name);
    return stage == stages.end() ? "no such stage" : stage->request;
}

BuildPaths paths_in(const fs::path& folder) {
    return {folder / "parts", folder / "x.vtkhdf", folder / "x.html"};
}

// How the asset of a case was made, as "pack" reads it.
std::string provenance_of(const CaseFile& file, const std::vector<Stage>& stages, const fs::path& folder) {
    const auto pack = std::ranges::find(stages, "pack", &Stage::name);
    prepare(*pack, file, paths_in(folder), stages, StageRunner(folder, folder / "parts", 1, true));
    std::ifstream stream(folder / "parts" / "provenance.json");
    return {std::istreambuf_iterator<char>(stream), {}};
}

TEST(Stages, one_that_comes_too_early_is_told_what_to_run_first) {
    const fs::path folder = fs::path(testing::TempDir()) / ("palpate_order_" + std::to_string(getpid()));
    fs::create_directories(folder / "parts");
    CaseFile file;
    file.name = "x";
    file.labels = folder / "l.nrrd";
    file.structures.push_back({.name = "liver", .recipe = "import", .files = {}});
    const std::vector<Stage> stages = stages_of(file, paths_in(folder));
    const StageRunner runner(folder, folder / "parts", 1, true);
    const auto stage = std::ranges::find(stages, "segment", &Stage::name);
    const std::string refusal = test::refusal_of([&] { require_made(*stage, stages, runner); });
    EXPECT_NE(refusal.find("run stage 'import labels' first"), std::string::npos) << refusal;
    std::ofstream(folder / "parts" / "prior.seg.nrrd") << "labels";
    require_made(*stage, stages, runner);
    fs::remove_all(folder);
}

TEST(Stages, the_frame_of_nifti_files_is_asked_for_only_where_the_input_is_one) {
    const fs::path folder = fs::path(testing::TempDir()) / ("palpate_frames_" + std::to_string(getpid()));
    fs::create_directories(folder / "series");
    std::ofstream(folder / "l.nii.gz") << "labels";
    CaseFile file;
    file.name = "x";
    file.volume = folder / "series";
    file.labels = folder / "l.nii.gz";
    file.volume_import.series = "3";
    file.volume_import.nifti_frame = file.labels_import.nifti_frame = "qform";
    const std::vector<Stage> stages = stages_of(file, paths_in(folder));
    EXPECT_EQ(request_of(stages, "import volume"),
              nlohmann::ordered_json({{"input", (folder / "series").string()},
                                      {"output", (folder / "parts" / "volume.nrrd").string()},
                                      {"series", "3"}}));
    EXPECT_EQ(request_of(stages, "import labels"),
              nlohmann::ordered_json({{"input", (folder / "l.nii.gz").string()},
                                      {"output", (folder / "parts" / "prior.seg.nrrd").string()},
                                      {"nifti_frame", "qform"},
                                      {"labels", true}}));
    fs::remove_all(folder);
}

TEST(Stages, imported_files_replace_image_and_labels_and_their_names_stay_out_of_the_asset) {
    const fs::path folder = fs::path(testing::TempDir()) / ("palpate_stages_" + std::to_string(getpid()));
    fs::create_directories(folder);
    for (const char* name : {"doe_john.msh", "doe_john.stl"}) std::ofstream(folder / name) << name;
    CaseFile file;
    file.name = "x";
    DeformableSpec liver;
    liver.name = "liver";
    liver.mesh.mesh_file = folder / "doe_john.msh";
    liver.mesh.unit = "cm";
    liver.mesh.frame = "ras";
    liver.mesh.region_names = {{1, "liver"}};
    liver.condense.materials = {{"liver", 6, 0.45}};
    file.deformable = {liver};
    file.quality.max_distance = 2;
    RigidSpec skull;
    skull.name = "skull";
    skull.surface.surface_file = folder / "doe_john.stl";
    skull.surface.max_triangles = 1000;
    skull.surface.max_distance = 0.5;
    file.rigid = {skull};
    const std::vector<Stage> stages = stages_of(file, paths_in(folder));

    std::vector<std::string> names;
    std::ranges::transform(stages, std::back_inserter(names), &Stage::name);
    EXPECT_EQ(names, (std::vector<std::string>{"surface skull", "mesh liver", "condense liver", "pack",
                                               "touch", "report"}));
    EXPECT_EQ(request_of(stages, "mesh liver").dump(),
              nlohmann::ordered_json(
                  {{"mesh_file", (folder / "doe_john.msh").string()},
                   {"mesh_unit", "cm"},
                   {"mesh_frame", "ras"},
                   {"region_name", {nlohmann::ordered_json{{"mesh_region", 1}, {"label", "liver"}}}},
                   {"max_distance_voxel_diagonals", 2.0},
                   {"output", (folder / "parts" / "liver.vtu").string()}})
                  .dump());
    EXPECT_EQ(request_of(stages, "surface skull").dump(),
              nlohmann::ordered_json({{"surface_file", (folder / "doe_john.stl").string()},
                                      {"max_triangles", 1000},
                                      {"max_distance_mm", 0.5},
                                      {"output", (folder / "parts" / "skull.vtp").string()}})
                  .dump());
    const std::string provenance = provenance_of(file, stages, folder);
    EXPECT_NE(provenance.find("liver_file_sha256"), std::string::npos);
    EXPECT_EQ(provenance.find("doe"), std::string::npos) << provenance;
    fs::remove_all(folder);
}

TEST(Stages, rules_of_a_body_reach_condense_and_its_node_files_decide_about_a_rerun) {
    const fs::path folder = fs::path(testing::TempDir()) / ("palpate_rules_" + std::to_string(getpid()));
    fs::create_directories(folder);
    const fs::path nodes = folder / "doe_john.txt";
    for (const fs::path& file : {nodes, folder / "liver.msh"}) std::ofstream(file) << "1\n";
    CaseFile file;
    file.name = "x";
    DeformableSpec liver;
    liver.name = "liver";
    liver.mesh.mesh_file = folder / "liver.msh";
    liver.condense.materials = {{"liver", 6, 0.45}};
    liver.condense.fixed.resize(2);
    liver.condense.fixed[0].touching = "skull";
    liver.condense.fixed[1].nodes_file = nodes;
    liver.condense.contact.resize(1);
    liver.condense.contact[0].region = "tumour";
    liver.condense.element = "quadratic";
    file.deformable = {liver};
    const std::vector<Stage> stages = stages_of(file, paths_in(folder));
    const auto request = request_of(stages, "condense liver");
    EXPECT_EQ(request["fixed"].dump(),
              R"([{"touching":"skull"},{"nodes_file":")" + nodes.string() + R"("}])");
    EXPECT_EQ(request["contact"].dump(), R"([{"region":"tumour"}])");
    EXPECT_EQ(request["element"], "quadratic");
    const auto condense = std::ranges::find(stages, "condense liver", &Stage::name);
    EXPECT_EQ(condense->inputs, (std::vector<fs::path>{folder / "parts" / "liver.vtu", nodes}));

    const std::string provenance = provenance_of(file, stages, folder);
    EXPECT_NE(provenance.find("liver_nodes_1_sha256"), std::string::npos);
    EXPECT_NE(provenance.find(R"("nodes_file": "liver_nodes_1")"), std::string::npos) << provenance;
    EXPECT_EQ(provenance.find("doe"), std::string::npos) << provenance;
    fs::remove_all(folder);
}

TEST(Stages, pack_gets_the_volume_for_the_eye_unless_the_case_keeps_it_out) {
    CaseFile file;
    file.rigid.resize(1);
    file.rigid[0].surface.surface_file = "skull.stl";
    const fs::path folder = "build", volume = folder / "parts" / "volume.nrrd";
    const auto pack_of = [&] {
        const std::vector<Stage> stages = stages_of(file, paths_in(folder));
        return *std::ranges::find(stages, "pack", &Stage::name);
    };
    EXPECT_FALSE(pack_of().request.contains("scan"));
    file.volume = "ct.nrrd";
    EXPECT_EQ(pack_of().request["scan"], volume.string());
    EXPECT_EQ(std::ranges::count(pack_of().inputs, volume), 1);
    file.keep_scan = false;
    EXPECT_FALSE(pack_of().request.contains("scan"));
    EXPECT_EQ(std::ranges::count(pack_of().inputs, volume), 0);
}

TEST(Stages, colours_reach_pack_alone_so_that_a_change_condenses_nothing) {
    CaseFile file;
    file.rigid.resize(1);
    file.rigid[0].surface.surface_file = "skull.stl";
    file.deformable.resize(1);
    const std::vector<Stage> plain = stages_of(file, paths_in("build"));
    file.rigid[0].colours = {{"skull", "", {255, 0, 0}}};
    file.deformable[0].colours = {{"wall", "tumour", {0, 0, 255}}};
    const std::vector<Stage> coloured = stages_of(file, paths_in("build"));
    EXPECT_EQ(
        request_of(coloured, "pack")["colour"].dump(),
        R"([{"body":"skull","colour":"#ff0000"},{"body":"wall","region":"tumour","colour":"#0000ff"}])");
    for (std::size_t i = 0; i < plain.size(); ++i) {
        if (plain[i].name != "pack") {
            EXPECT_EQ(plain[i].request, coloured[i].request) << plain[i].name;
        }
    }
}

TEST(Stages, a_finished_asset_is_pressed_in_real_time_unless_the_clock_is_virtual) {
    CaseFile file;
    file.rigid.resize(1);
    file.rigid[0].surface.surface_file = "skull.stl";
    const fs::path folder = "build";
    EXPECT_FALSE(request_of(stages_of(file, paths_in(folder)), "touch").contains("virtual_clock"));
    const auto stages = stages_of(file, paths_in(folder), TouchClock::virtual_time);
    EXPECT_EQ(request_of(stages, "touch")["virtual_clock"], true);
}

}  // namespace
}  // namespace palpate::case_builder
