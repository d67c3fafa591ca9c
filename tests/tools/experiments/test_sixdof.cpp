// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <fstream>
#include <gtest/gtest.h>

#include "runtime/haptics/whole_tool/rod.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tools/experiments/rigid_case.hpp"
#include "tools/experiments/sixdof/bullet_judge.hpp"
#include "tools/experiments/sixdof/fcl_judge.hpp"
#include "tools/experiments/sixdof/sixdof.hpp"
#include "tools/experiments/sixdof/tool_approaches.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace palpate::experiments {
namespace {

using Eigen::Vector3d;

cli::Session quiet_session(int threads = 1) {
    return {.threads = threads, .progress = cli::Progress(true), .shortfall = {}, .form = {}, .text = {}};
}

void write_stl(const std::filesystem::path& file, const TriangleMesh& mesh) {
    std::ofstream stl(file);
    stl.precision(9);
    stl << "solid tool\n";
    for (const Triangle& t : mesh.triangles) {
        stl << "facet normal 0 0 0\nouter loop\n";
        for (const std::int32_t corner : t)
            stl << "vertex " << mesh.vertices[static_cast<std::size_t>(corner)].transpose() << "\n";
        stl << "endloop\nendfacet\n";
    }
    stl << "endsolid tool\n";
}

TEST(BulletJudge, tells_how_deep_the_deepest_triangle_is) {
    const TriangleMesh tool = haptics::rod_surface(1, 10);
    const BulletJudge bullet(plate_surface(), tool);
    const FclJudge fcl(plate_surface(), tool);
    // The ball's lowest triangles are 0.03 mm high: what is deeper is told as less.
    for (const double depth : {-0.5, 0.01, 0.03, 0.2}) {
        Eigen::Isometry3d X_PT = Eigen::Isometry3d::Identity();
        X_PT.translation() = Vector3d(0.3, 0.7, 1 - depth);
        if (depth < 0.1) {
            EXPECT_NEAR(bullet.depth(X_PT), std::max(0.0, depth), 1e-3);
        } else {
            EXPECT_GT(bullet.depth(X_PT), 0.03);
            EXPECT_LT(bullet.depth(X_PT), depth);
        }
        EXPECT_EQ(fcl.meet(X_PT), depth > 0);
        if (depth < 0) {
            EXPECT_NEAR(fcl.distance(X_PT), -depth, 1e-3);
        }
    }
}

// A foil that points do not know the sides of, and triangles do.
TEST(ToolApproaches, count_what_goes_through_a_foil) {
    Case foil = rigid_case("foil", plate_surface(0.05), {});
    foil.tool = ToolBody{haptics::rod_surface(1, 15), {.shell_points = 500, .voxel = 1}};
    const FclJudge judge(foil.rigid_bodies[0].surface, foil.tool->surface);
    const std::vector<Vector3d> core{{0, 0, 0}, {0, 0, 5}, {0, 0, 15}};
    const std::vector<Place> places{{.entry = {7, 11, 0}, .direction = {0, 0, -1}, .thickness = 0.05}};
    const auto approach = [&](const char* scheme, std::size_t threads) {
        std::vector<std::unique_ptr<haptics::HapticModel>> models;
        for (std::size_t i = 0; i < threads; ++i)
            models.push_back(std::make_unique<haptics::HapticModel>(foil, scheme));
        std::mt19937_64 random(4);
        return approach_with_tool(models, judge, core, places, 30, random, [](double) {});
    };
    const ToolApproaches points = approach("shell", 1), ours = approach("solid", 1),
                         spheres = approach("continuous", 1);
    EXPECT_EQ(points.count, 30);
    EXPECT_GT(points.through, 20);
    EXPECT_EQ(points.beyond, points.through);
    for (const ToolApproaches& all : {ours, spheres}) {
        EXPECT_EQ(all.count, 30);
        EXPECT_EQ(all.began_inside, 0);
        EXPECT_EQ(all.through, 0);
        EXPECT_EQ(all.beyond, 0);
        EXPECT_EQ(all.unsolved, 0);
    }
    EXPECT_EQ(ours.met, 0);
    const ToolApproaches shared = approach("shell", 3);
    EXPECT_EQ(shared.through, points.through);
    EXPECT_EQ(shared.met, points.met);
}

TEST(Sixdof, measures_every_way_to_feel_a_tool) {
    const sample::Scratch scratch;
    meshing::write_surface(scratch / "ball.vtp", sample::sphere_surface(Vector3d::Zero(), 30, 3));
    write_stl(scratch / "rod.stl", haptics::rod_surface(1.5, 20));
    cli::Session session = quiet_session();
    Options options;
    options.surfaces = {scratch / "ball.vtp"};
    options.tools = {scratch / "rod.stl"};
    options.seconds = 1;
    options.approaches = 3;
    const auto rows = sixdof(options, session).result["rows"];
    ASSERT_EQ(rows.size(), 6);
    for (const auto& row : rows) {
        const std::string scheme = row["scheme"];
        SCOPED_TRACE(scheme);
        EXPECT_EQ(row["tool"], "rod");
        EXPECT_GT(row["touching"], 300);
        EXPECT_GT(row["judged"], 20);
        EXPECT_GT(row["force_max_n"], 1);
        EXPECT_LT(row["drift_mm"], 1e-3);                                   // at rest on a ball
        EXPECT_LT(row["unfelt_deepest_mm"], double(row["gap_mm"]) + 0.01);  // beside samples
        EXPECT_EQ(row["approaches"], 3);
        EXPECT_EQ(row["approaches_through"], 0);
        const double deepest = row["deepest_mm"];
        EXPECT_NEAR(row["by_bullet_mm"], std::max(0.0, deepest), 0.02);
        if (scheme == "solid" || scheme == "cones" || scheme == "features") {
            EXPECT_EQ(row["met"], 0);
            EXPECT_EQ(row["approaches_met"], 0);
        } else {
            EXPECT_LT(deepest, 0.3);
        }
    }
    options.schemes = {"solid"};
    EXPECT_EQ(sixdof(options, session).result["rows"].size(), 1);
    options.schemes = {"solids"};
    EXPECT_THROW(sixdof(options, session), UsageError);
}

}  // namespace
}  // namespace palpate::experiments
