// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/sixdof/sixdof.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <ranges>

#include "formats/model/arrays.hpp"
#include "formats/stl_file/read_stl.hpp"
#include "runtime/collision/points/point_shell.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "runtime/haptics/tool_pose.hpp"
#include "runtime/haptics/whole_tool/tool_spheres.hpp"
#include "tools/experiments/rigid_case.hpp"
#include "tools/experiments/sixdof/tool_approaches.hpp"
#include "tools/experiments/sixdof/tool_judge.hpp"
#include "tools/experiments/sixdof/tool_visits.hpp"
#include "tools/experiments/tick/tick_runs.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace palpate::experiments {
namespace {

using namespace haptics;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr std::string_view method =
    R"(# Whole tools on a bone, with `continuous`, `shell`, `cones`, `features` and `solid`

Each tool visits random places of the bone's outside, one for each of `--seconds`: it comes along the normal at 20 to 200 mm/s, tilted by up to 40
degrees, its device goes 3 mm deep, slides 10 mm while it turns by up to 30 degrees, rests for 0.3 s, and leaves. Ticks: one
core, wall clock, us, of each tick but a visit's first the shortest of {} passes; `touching` are those with force. `drift` is how
far any point of the tool goes at most from 0.1 s after the device came to rest on. Every 20th tick the tool's pose is
judged: `deepest` is the greatest depth of 20 000 other points of the tool below the bone by exact distances, `by Bullet` that of
its triangles, `told` what the tick said of its own touches; `unfelt` counts poses that overlap the bone by FCL's triangles and
have no force, with the greatest depth of any of them, and `met` all that overlap; `apart` is the largest difference between the
tool's distance from the bone by FCL and by the shell's points where it is clear and nearer than 2 mm. `unsettled` counts ticks
whose search for rest ended on its way. `gap` is the farthest of the surface's points from the shell's, or from the spheres of
`continuous`. Coupling 0.5 N/mm and 450 N mm/rad.

| tool | scheme | triangles | points | gap, mm | voxel, mm | set-up, s | ticks | touching | p50 | p99 | p99.9 | max | told, mm | deepest, mm | by Bullet, mm | met, of judged | unfelt | unfelt deepest, mm | apart, mm | force, N | torque, N mm | drift, mm | unsettled |
|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|
)";

constexpr std::string_view approaches_method = R"(
Fast approaches: at 50 to 1 000 mm/s, turning at up to 20 rad/s, to 10 mm below the surface. In every tick `met` asks FCL whether a triangle of
the tool meets one of the bone, and `through` whether the tool's core, the centres of {} spheres at most that fill it best, went
through the bone's surface since the tick before, straight. `beyond` ends more than 5 mm below the surface: beside the bone,
through a gap or through bone. `began inside` is a tool that another part of the bone was in at the start; it is not in the other
columns.

| tool | scheme | approaches | began inside | through | met | beyond | with an unsolved tick |
|---|---|--:|--:|--:|--:|--:|--:|
)";

// Ways to hold a tool: points are the shell's, and otherwise say nothing.
struct Way {
    std::string_view scheme;
    std::int32_t points;
};
constexpr std::array<Way, 6> ways{{{"continuous", 5000},
                                   {"shell", 5000},
                                   {"shell", 50'000},
                                   {"cones", 5000},
                                   {"features", 5000},
                                   {"solid", 5000}}};
constexpr std::int64_t judged_every = 20;
constexpr double settling = 0.1;  // s
constexpr std::size_t core_spheres = 32;
constexpr std::int64_t most_targets = 10'000;  // of fast approaches, in turn
constexpr double place_radius = 3;             // mm: of a tool that is as free as places are

struct Row {
    std::string tool, scheme;
    std::size_t triangles = 0, points = 0;
    double gap = 0, voxel = 0, set_up_s = 0, told = 0, force = 0, torque = 0, drift = 0;
    std::int64_t ticks = 0, touching = 0, unsettled = 0;
    Judged judged;
    ToolApproaches approaches;
    realtime::Histogram times{};
};

// How far any point of the tool goes at most from one tick's pose to another's, mm.
double way_between(const TickResult& from, const TickResult& to, double longest_arm) {
    const auto pose = [](const TickResult& result) {
        return ToolPose{vector_of(result.tool_position), quaternion_of(result.tool_orientation)};
    };
    return motion_between(pose(from), pose(to)).of(longest_arm);
}

void press(HapticModel& model, const std::vector<ToolVisit>& visits, const ToolJudge& judge,
           double longest_arm, Row& row) {
    Shortest times;
    TickResult result{}, settled{};
    for (int pass = 0; pass < Shortest::passes; ++pass) {
        std::size_t step = 0;
        for (const ToolVisit& visit : visits) {
            model.reset();
            devices::SimulatedDevice hand(visit.path, {});
            const auto tick_at = [](double time) { return static_cast<std::int64_t>(1000 * time); };
            for (std::int64_t tick = 0; tick < tick_at(visit.path.duration()); ++tick) {
                const realtime::DeviceState state = hand.read(1e-3 * static_cast<double>(tick));
                const std::uint64_t took = nanoseconds_of([&] { model.tick(state, result); });
                if (tick > 0) times.record(step++, took);  // in the first, every point is looked at
                if (pass > 0) continue;
                ++row.ticks;
                row.touching += result.contact_count > 0;
                row.unsettled += (result.status & contact_unsettled) != 0;
                row.told = std::max(row.told, result.residual);
                row.force = std::max(row.force, vector_of(result.force).norm());
                row.torque = std::max(row.torque, vector_of(result.torque).norm());
                if (tick == tick_at(visit.rests_from + settling)) settled = result;
                if (tick > tick_at(visit.rests_from + settling) && tick < tick_at(visit.rests_until))
                    row.drift = std::max(row.drift, way_between(settled, result, longest_arm));
                if (tick % judged_every == 0 && !(result.status & starts_inside))
                    judge.judge(result, row.judged);
            }
        }
    }
    row.times = times.histogram();
}

double us(const Row& row, double share) {
    return 1e-3 * static_cast<double>(row.times.percentile(share));
}

Json json_of(const Row& row) {
    const auto& [poses, met, unfelt, deepest, by_bullet, unfelt_deepest, apart] = row.judged;
    return {{"tool", row.tool},
            {"scheme", row.scheme},
            {"triangles", row.triangles},
            {"points", row.points},
            {"gap_mm", row.gap},
            {"voxel_mm", row.voxel},
            {"set_up_s", row.set_up_s},
            {"ticks", row.ticks},
            {"touching", row.touching},
            {"p50_us", us(row, 0.5)},
            {"p99_us", us(row, 0.99)},
            {"p99.9_us", us(row, 0.999)},
            {"max_us", us(row, 1)},
            {"told_mm", row.told},
            {"deepest_mm", deepest},
            {"by_bullet_mm", by_bullet},
            {"judged", poses},
            {"met", met},
            {"unfelt", unfelt},
            {"unfelt_deepest_mm", unfelt_deepest},
            {"apart_mm", apart},
            {"force_max_n", row.force},
            {"torque_max_n_mm", row.torque},
            {"drift_mm", row.drift},
            {"unsettled", row.unsettled},
            {"approaches", row.approaches.count},
            {"approaches_begun_inside", row.approaches.began_inside},
            {"approaches_through", row.approaches.through},
            {"approaches_met", row.approaches.met},
            {"approaches_beyond", row.approaches.beyond},
            {"approaches_unsolved", row.approaches.unsolved}};
}

std::string row_of(const Row& row) {
    const Judged& judged = row.judged;
    return fmt::format(
        "| {} | {} | {} | {} | {:.2f} | {:g} | {:.1f} | {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.3f} "
        "| {:.3f} | {:.3f} | {} of {} | {} | {:.3f} | {:.3f} | {:.2f} | {:.0f} | {:.1g} | {} |\n",
        row.tool, row.scheme, row.triangles, row.points, row.gap, row.voxel, row.set_up_s, row.ticks,
        row.touching, us(row, 0.5), us(row, 0.99), us(row, 0.999), us(row, 1), row.told, judged.deepest,
        judged.by_bullet, judged.met, judged.poses, judged.unfelt, judged.unfelt_deepest, judged.apart,
        row.force, row.torque, row.drift, row.unsettled);
}

std::string approaches_row_of(const Row& row) {
    const ToolApproaches& all = row.approaches;
    return fmt::format("| {} | {} | {} | {} | {} | {} | {} | {} |\n", row.tool, row.scheme, all.count,
                       all.began_inside, all.through, all.met, all.beyond, all.unsolved);
}

// One way to feel one tool on a bone. The bone holds the tool.
Row measure(const Case& bone, const std::string& tool_name, const Way& way, const Options& options,
            cli::Session& session) {
    const TriangleMesh& surface = bone.rigid_bodies[0].surface;
    const TriangleMesh& tool = bone.tool->surface;
    Row row;
    row.tool = tool_name;
    row.scheme = way.scheme;
    row.triangles = tool.triangles.size();
    const std::int64_t begin = realtime::monotonic_ns();
    std::vector<std::unique_ptr<HapticModel>> models;
    models.push_back(std::make_unique<HapticModel>(bone, way.scheme));
    row.set_up_s = 1e-9 * static_cast<double>(realtime::monotonic_ns() - begin);
    HapticModel& model = *models.front();
    collision::PointShell shell;
    if (way.scheme == "continuous") {
        row.points = model.tool_spheres().size();
        row.gap = fill_with_spheres(tool, row.points).largest_gap;
    }
    if (way.scheme == "shell") {
        row.points = static_cast<std::size_t>(way.points);
        row.voxel = bone.tool->settings.voxel;
        shell = collision::point_shell(tool, row.points);
        row.gap = shell.covering_radius;
    }
    std::mt19937_64 random(options.seed);
    const auto visits_wanted =
        static_cast<std::size_t>(options.seconds > 0 ? std::ceil(options.seconds) : 60);
    const auto places = draw_places(surface, model.surface(0), place_radius, visits_wanted, random);
    std::vector<ToolVisit> visits;
    for (const Place& place : places) visits.push_back(pressing_visit(place, model.contact_radius(), random));
    double longest_arm = 0;
    for (const Vector3d& vertex : tool.vertices) longest_arm = std::max(longest_arm, vertex.norm());
    press(model, visits, ToolJudge(surface, model.surface(0), tool, shell.points), longest_arm, row);
    while (models.size() < static_cast<std::size_t>(session.threads))
        models.push_back(std::make_unique<HapticModel>(bone, way.scheme));
    std::vector<Vector3d> core;
    for (const ToolSphere& sphere : fill_with_spheres(tool, core_spheres).spheres)
        core.push_back(sphere.centre);
    const std::int64_t count = options.approaches > 0 ? options.approaches : 1000;
    const auto targets = draw_places(surface, model.surface(0), place_radius,
                                     static_cast<std::size_t>(std::min(count, most_targets)), random);
    row.approaches = approach_with_tool(
        models, FclJudge(surface, tool), core, targets, count, random,
        [&](double done) { session.progress.step(tool_name + ", fast", 0.5 + 0.5 * done); });
    return row;
}

}  // namespace

Findings sixdof(const Options& options, cli::Session& session) {
    if (options.surfaces.size() != 1)
        throw UsageError(
            {"--surface", std::to_string(options.surfaces.size()) + " are given", "one bone", ""});
    if (options.tools.empty())
        throw UsageError({"--instrument", "none is given",
                          "closed surfaces of instruments (.stl), one or more",
                          "sample_data/tools.py makes some"});
    const auto is_meant = [&](const Way& way) {
        return options.schemes.empty() || std::ranges::count(options.schemes, way.scheme) > 0;
    };
    for (const std::string& scheme : options.schemes)
        if (std::ranges::count(ways, scheme, &Way::scheme) == 0)
            throw UsageError({"--scheme", scheme, "continuous, shell, cones, features, solid", ""});
    Case bone = rigid_case("bone", meshing::read_surface(options.surfaces.front()), HapticSettings{});
    Findings findings;
    std::string approaches = fmt::format(approaches_method, core_spheres);
    findings.table = fmt::format(method, Shortest::passes);
    for (const std::filesystem::path& file : options.tools)
        for (const Way& way : ways | std::views::filter(is_meant)) {
            const std::string name = file.stem().string();
            session.progress.step(name, 0);
            bone.tool = ToolBody{stl_file::read_stl(file), {.shell_points = way.points}};
            const Row row = measure(bone, name, way, options, session);
            findings.result["rows"].push_back(json_of(row));
            findings.table += row_of(row);
            approaches += approaches_row_of(row);
        }
    findings.table += approaches;
    session.progress.finish();
    return findings;
}

}  // namespace palpate::experiments
