// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fstream>
#include <gtest/gtest.h>
#include <iterator>
#include <unistd.h>

#include "tools/case_builder/stages.hpp"

namespace palpate::build {
namespace {

namespace fs = std::filesystem;

std::string line_of(const std::vector<Stage>& stages, const std::string& name) {
    const auto stage = std::ranges::find(stages, name, &Stage::name);
    if (stage == stages.end()) return "no such stage";
    std::string line = stage->command;
    for (const std::string& argument : stage->arguments) line += " " + argument;
    return line;
}

TEST(Stages, the_frame_of_nifti_files_is_asked_for_only_where_the_input_is_one) {
    const fs::path folder = fs::path(testing::TempDir()) / ("palpate_frames_" + std::to_string(getpid()));
    fs::create_directories(folder / "series");
    std::ofstream(folder / "l.nii.gz") << "labels";
    CaseFile file;
    file.name = "x";
    file.volume = folder / "series";
    file.labels = folder / "l.nii.gz";
    file.volume_options = {"--series", "3", "--nifti-frame", "qform"};
    file.labels_options = {"--nifti-frame", "qform"};
    const std::vector<Stage> stages =
        stages_to_asset(file, {folder / "parts", folder / "x.vtkhdf", folder / "x.html"});
    EXPECT_NE(line_of(stages, "import volume").find("series --series 3 -o"), std::string::npos);
    EXPECT_NE(line_of(stages, "import labels").find("--labels --nifti-frame qform -o"), std::string::npos);
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
    liver.file = ImportedFile{folder / "doe_john.msh", "cm", "ras"};
    liver.regions = {{"liver", 6, 0.45, {}, 1}};
    file.deformable = {liver};
    RigidSpec skull;
    skull.name = "skull";
    skull.file = ImportedFile{folder / "doe_john.stl"};
    skull.max_triangles = 1000;
    skull.max_distance = 0.5;
    file.rigid = {skull};
    const std::vector<Stage> stages =
        stages_to_asset(file, {folder / "parts", folder / "x.vtkhdf", folder / "x.html"});

    std::vector<std::string> names;
    std::ranges::transform(stages, std::back_inserter(names), &Stage::name);
    EXPECT_EQ(names, (std::vector<std::string>{"surface skull", "obb skull", "mesh liver", "obb liver",
                                               "condense liver", "pack"}));
    EXPECT_EQ(line_of(stages, "mesh liver"), "mesh --mesh-file " + (folder / "doe_john.msh").string() +
                                                 " --unit cm --frame ras --region-name 1=liver -o " +
                                                 (folder / "parts" / "liver.vtu").string());
    EXPECT_EQ(line_of(stages, "surface skull"), "surface --surface-file " +
                                                    (folder / "doe_john.stl").string() +
                                                    " --unit mm --max-triangles 1000 --max-distance 0.5 -o " +
                                                    (folder / "parts" / "skull.vtp").string());
    std::ifstream stream(folder / "parts" / "provenance.json");
    const std::string provenance{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_NE(provenance.find("liver_file_sha256"), std::string::npos);
    EXPECT_EQ(provenance.find("doe"), std::string::npos) << provenance;
    fs::remove_all(folder);
}

TEST(Stages, rules_and_options_of_a_body_reach_condense_and_its_node_files_decide_about_a_rerun) {
    const fs::path folder = fs::path(testing::TempDir()) / ("palpate_rules_" + std::to_string(getpid()));
    fs::create_directories(folder);
    const fs::path nodes = folder / "doe_john.txt";
    for (const fs::path& file : {nodes, folder / "liver.msh"}) std::ofstream(file) << "1\n";
    CaseFile file;
    file.name = "x";
    DeformableSpec liver;
    liver.name = "liver";
    liver.file = ImportedFile{folder / "liver.msh"};
    liver.regions = {{"liver", 6, 0.45, {}, 1}};
    liver.fixed = {"touching:skull", "nodes:" + nodes.string()};
    liver.contact = {"region:tumour"};
    liver.node_files = {nodes};
    liver.condense_options = {"--element", "quadratic", "--accuracy", "0.001"};
    file.deformable = {liver};
    const std::vector<Stage> stages =
        stages_to_asset(file, {folder / "parts", folder / "x.vtkhdf", folder / "x.html"});
    EXPECT_NE(line_of(stages, "condense liver")
                  .find(" --fixed touching:skull --fixed nodes:" + nodes.string() +
                        " --contact region:tumour --element quadratic --accuracy 0.001 -o "),
              std::string::npos)
        << line_of(stages, "condense liver");
    const auto condense = std::ranges::find(stages, "condense liver", &Stage::name);
    EXPECT_EQ(condense->inputs, (std::vector<fs::path>{folder / "parts" / "liver.vtu", nodes}));

    std::ifstream stream(folder / "parts" / "provenance.json");
    const std::string provenance{std::istreambuf_iterator<char>(stream), {}};
    EXPECT_NE(provenance.find("liver_nodes_1_sha256"), std::string::npos);
    EXPECT_NE(provenance.find("--fixed nodes:liver_nodes_1 "), std::string::npos) << provenance;
    EXPECT_EQ(provenance.find("doe"), std::string::npos) << provenance;
    fs::remove_all(folder);
}

}  // namespace
}  // namespace palpate::build
