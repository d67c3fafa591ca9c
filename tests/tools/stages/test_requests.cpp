// SPDX-License-Identifier: GPL-3.0-or-later
// What is asked for as JSON is what arrives: every request, written and read again by its command's options.
#include <fstream>
#include <gtest/gtest.h>
#include <limits>

#include "tests/formats/scratch.hpp"
#include "tools/cli/items.hpp"
#include "tools/stages/requests/condense_request.hpp"
#include "tools/stages/requests/import_request.hpp"
#include "tools/stages/requests/mesh_request.hpp"
#include "tools/stages/requests/pack_request.hpp"
#include "tools/stages/requests/report_request.hpp"
#include "tools/stages/requests/segment_request.hpp"
#include "tools/stages/requests/surface_request.hpp"

namespace palpate::stages {
namespace {

using Json = nlohmann::ordered_json;

const sample::Scratch& folder() {
    static const sample::Scratch folder;  // of each process, as tests run side by side
    return folder;
}

std::filesystem::path existing(const std::string& name) {
    std::ofstream(folder() / name) << "there";
    return folder() / name;
}

template <typename Request>
struct Outcome {
    int code = 0;
    Request request;
};

// Reads words as the command of a request does.
template <typename Request>
Outcome<Request> read(std::vector<std::string> words) {
    Outcome<Request> outcome;
    cli::Command command({.name = "test", .summary = "", .examples = {}, .notes = ""});
    declare(command, outcome.request);
    words.insert(words.begin(), "palpate-test");
    words.emplace_back("--quiet");
    std::vector<char*> argv;
    for (std::string& word : words) argv.push_back(word.data());
    outcome.code =
        command.run(static_cast<int>(argv.size()), argv.data(), [](cli::Session&) { return Json::object(); });
    return outcome;
}

template <typename Request>
Outcome<Request> read_json(const Json& json, std::vector<std::string> more = {}) {
    const auto file = folder() / "request.json";
    std::ofstream(file) << json.dump(2);
    more.insert(more.begin(), {"--request", file.string()});
    return read<Request>(more);
}

template <typename Request>
void expect_round_trip(const Request& request, std::size_t fields) {
    const Json json = cli::to_request(request);
    EXPECT_EQ(json.size(), fields) << json.dump(2);
    const auto [code, again] = read_json<Request>(json);
    EXPECT_EQ(code, cli::ExitCode::ok) << json.dump(2);
    EXPECT_EQ(cli::to_request(again), json);
}

TEST(Request, of_import_survives_json) {
    expect_round_trip(ImportRequest{.input = existing("in"),
                                    .output = "out.nrrd",
                                    .list = true,
                                    .series = "3",
                                    .accept_gaps = true,
                                    .nifti_frame = "qform",
                                    .scale = 15.725,
                                    .offset = -1024,
                                    .deface = true,
                                    .labels = true,
                                    .label_names = "5=liver,4=gallbladder",
                                    .overlaps = "smaller"},
                      12);
}

TEST(Request, of_segment_survives_json_with_parameters_in_their_order) {
    SegmentRequest request{.volume = existing("v.nrrd"),
                           .labels = existing("l.nrrd"),
                           .recipes = existing("r.json"),
                           .structures = {},
                           .preview = "seen.png",
                           .output = "out.seg.nrrd"};
    request.structures.push_back({.words = "", .name = "left, kidney", .recipe = "threshold"});
    request.structures.back().parameters = {
        {"smooth_mm", 1.5}, {"keep_largest", true}, {"center_mm", {1, 2.25, -3}}};
    request.structures.push_back({.words = "", .name = "[skull]", .recipe = "bone"});
    expect_round_trip(request, 6);
    const auto read_again = read_json<SegmentRequest>(cli::to_request(request)).request;
    EXPECT_EQ(read_again.structures.at(0).parameters.dump(), request.structures[0].parameters.dump());
}

TEST(Request, of_segment_keeps_a_bound_that_is_none) {
    constexpr double infinity = std::numeric_limits<double>::infinity();
    SegmentRequest request;
    request.structures.push_back({.words = "", .name = "all", .recipe = "threshold"});
    request.structures.back().parameters = {{"lower_hu", -infinity}, {"upper_hu", infinity}};
    request.output = "out.seg.nrrd";
    const auto read_again = read_json<SegmentRequest>(cli::to_request(request)).request;
    EXPECT_EQ(read_again.structures.at(0).parameters, request.structures[0].parameters);
}

TEST(Request, of_surface_survives_json) {
    SurfaceRequest request;
    request.volume = existing("v.nrrd");
    request.isovalue = 0;
    request.labels = existing("l.nrrd");
    request.label_names = {"a b", "4"};
    request.mask_reach = 3;
    request.smoothing = 0.1;
    request.keep_largest = true;
    request.min_triangles = 7;
    request.max_triangles = 10;
    request.max_distance = 1.0 / 3;
    request.output = "out.vtp";
    expect_round_trip(request, 11);
    SurfaceRequest imported;
    imported.surface_file = existing("s.stl");
    imported.unit = "cm";
    imported.frame = "ras";
    imported.output = "out.vtp";
    expect_round_trip(imported, 4);
}

TEST(Request, of_mesh_survives_json) {
    MeshRequest request;
    request.labels = existing("l.nrrd");
    request.regions = {"liver", "tumour"};
    request.sizing = {.cell_size = 8, .facet_size = 7, .facet_distance = 0.1};
    request.sizing.smoothing = 1;
    request.sizing.min_component_volume = 3;
    request.region_cell_sizes = {{"tumour", 4}};
    request.near = {{.label = "tumour", .point = {}, .within = 10, .cell_size = 3},
                    {.label = "", .point = {{12, -40, 0.1}}, .within = 5, .cell_size = 2}};
    request.allow_components = true;
    request.contract.min_dihedral_deg = 10;
    request.contract.min_dice = 0.5;
    request.attempts = 2;
    request.output = "out.vtu";
    expect_round_trip(request, 14);
    MeshRequest imported;
    imported.mesh_file = existing("m.msh");
    imported.unit = "cm";
    imported.frame = "ras";
    imported.region_names = {{4, "tumour, left"}, {5, "liver"}};
    imported.output = "out.vtu";
    expect_round_trip(imported, 5);
}

TEST(Request, of_condense_survives_json) {
    CondenseRequest request;
    request.mesh = existing("m.vtu");
    request.name = "wall";
    request.materials = {{"wall:a", 6.3, 0.45}};
    request.fixed.resize(4);
    request.fixed[3].facing = {0, 1, 0};
    request.fixed[0].touching = "skull";
    request.fixed[1].sphere_mm = {1, 2, 3.5, 4};
    request.fixed[2].nodes_file = "rim.txt";
    request.contact.resize(3);
    request.contact[0].region = "tumour";
    request.contact[1].box_mm = {0, 0, 0, 1, 1, 1};
    request.contact[2].plane_mm = {0, 0, 0, 0, 0, 1};
    request.element = "quadratic";
    request.representation = "dense";
    request.accuracy = 2e-3;
    request.memory_gib = 2.5;
    request.size_mib = 50;
    request.discretisation_error = true;
    request.output = "out.body.h5";
    expect_round_trip(request, 12);
}

TEST(Request, of_pack_survives_json) {
    PackRequest request;
    request.name = "head";
    request.rigid = {{"skull", "a,b.vtp", ""}, {"spine", "c.vtp", "c.obb.h5"}};
    request.deformable = {{"wall", "w.body.h5", ""}};
    request.haptics.tool_radius = 1.5;
    request.haptics.max_force_rate = 0.25;
    request.scan = existing("volume.nrrd");
    request.colours = {{"skull", "", {1, 2, 255}}, {"wall", "tumour: left", {0, 16, 160}}};
    request.mesh_results = {{"wall", "w=1.json"}};
    request.notes = {existing("import.json"), existing("segment.json")};
    request.provenance = existing("p.json");
    request.output = "out.vtkhdf";
    expect_round_trip(request, 11);
}

TEST(Request, of_pack_takes_colours_of_bodies_and_of_regions) {
    const auto read_colours = [](const std::string& word) {
        return read<PackRequest>({"--name", "x", "-o", "x.vtkhdf", "--colour", word});
    };
    const DrawnColour body = read_colours("my liver=#7a3A2f").request.colours.at(0);
    EXPECT_EQ(body.body, "my liver");
    EXPECT_EQ(body.region, "");
    EXPECT_EQ(body.colour, (Colour{0x7a, 0x3a, 0x2f}));
    const DrawnColour region = read_colours("liver:tumour=left: a=#000001").request.colours.at(0);
    EXPECT_EQ(region.body, "liver");
    EXPECT_EQ(region.region, "tumour=left: a");
    EXPECT_EQ(region.colour, (Colour{0, 0, 1}));
    for (const char* word : {"liver", "=#000000", "liver=red", "liver=#00000", "liver="})
        EXPECT_EQ(read_colours(word).code, cli::ExitCode::usage) << word;
}

TEST(Request, of_report_survives_json) {
    expect_round_trip(ReportRequest{.asset = existing("a.vtkhdf"),
                                    .failed_with = existing("e.txt"),
                                    .name = "liver",
                                    .volume = existing("v.nrrd"),
                                    .labels = existing("l.nrrd"),
                                    .rigid = {{"skull", "bone", 226.0}, {"spine", "spine", {}}},
                                    .touch = existing("t.json"),
                                    .curve = existing("c.svg"),
                                    .stages = existing("s.json"),
                                    .thumbnail = "t.png",
                                    .output = "out.html"},
                      11);
}

TEST(Request, words_and_json_ask_for_the_same) {
    const std::string mesh = existing("m.vtu").string();
    const auto words = read<CondenseRequest>(
        {mesh, "--material", "liver:6.3,0.45", "--accuracy", "0.002", "--discretisation-error", "-o", "x"});
    const auto json = read_json<CondenseRequest>(
        {{"mesh", mesh},
         {"material", {Json{{"label", "liver"}, {"youngs_modulus_kpa", 6.3}, {"poissons_ratio", 0.45}}}},
         {"accuracy", 0.002},
         {"discretisation_error", true},
         {"output", "x"}});
    ASSERT_EQ(words.code, cli::ExitCode::ok);
    EXPECT_EQ(cli::to_request(words.request), cli::to_request(json.request));
}

TEST(Request, an_option_goes_before_the_file) {
    const Json json{{"name", "head"}, {"tool_radius_mm", 2}, {"output", "x"}};
    EXPECT_EQ(read_json<PackRequest>(json).request.haptics.tool_radius, 2);
    EXPECT_EQ(read_json<PackRequest>(json, {"--tool-radius", "3"}).request.haptics.tool_radius, 3);
}

TEST(Request, is_held_to_the_rules_of_the_options) {
    const auto code = [](const Json& json) { return read_json<SurfaceRequest>(json).code; };
    const std::string file = existing("v.nrrd").string();
    EXPECT_EQ(code({{"labels", file}, {"label", {"a"}}, {"output", "x"}}), cli::ExitCode::ok);
    EXPECT_EQ(code({{"labels", file}, {"label", {"a"}}}), cli::ExitCode::usage);         // no output
    EXPECT_EQ(code({{"volume", file}, {"output", "x"}}), cli::ExitCode::usage);          // no isovalue
    EXPECT_EQ(code({{"max_triangles", "few"}, {"output", "x"}}), cli::ExitCode::usage);  // no number
    EXPECT_EQ(code({{"labels", "absent"}, {"output", "x"}}), cli::ExitCode::invalid_input);
    EXPECT_EQ(code({{"lables", file}, {"output", "x"}}), cli::ExitCode::invalid_input);
    EXPECT_EQ(code(Json::array({1})), cli::ExitCode::invalid_input);
    EXPECT_EQ(read<SurfaceRequest>({"--request", (folder() / "absent.json").string()}).code,
              cli::ExitCode::invalid_input);
    EXPECT_EQ(
        read_json<MeshRequest>({{"refine", {Json{{"near", "a"}, {"within", 3}}}}, {"output", "x"}}).code,
        cli::ExitCode::usage);
}

}  // namespace
}  // namespace palpate::stages
