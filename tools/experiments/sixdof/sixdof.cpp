// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/sixdof/sixdof.hpp"

#include <algorithm>
#include <array>
#include <fmt/format.h>

#include "formats/model/arrays.hpp"
#include "formats/stl_file/read_stl.hpp"
#include "runtime/collision/points/point_shell.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "runtime/haptics/whole_tool/tool_spheres.hpp"
#include "tools/experiments/rigid_case.hpp"
#include "tools/experiments/sixdof/fcl_judge.hpp"
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

Each tool visits random places of the bone's outside: it comes along the normal at 20 to 200 mm/s, tilted by up to 40
degrees, its device goes 3 mm deep, slides 10 mm while it turns by up to 30 degrees, and leaves. Ticks: one core, wall
clock, us, of each tick but a visit's first the shortest of {} passes; `touching` are those with force. Every 20th tick the tool's pose is
judged: `deepest` is the greatest depth of 20 000 other points of the tool below the bone by exact distances, `told` what
the tick said of its own touches; `unfelt` counts poses that overlap the bone by FCL's triangles and have no force, with
the greatest depth of any of them, and `met` all that overlap; `apart` is the largest difference between the tool's distance
from the bone by FCL and by the shell's points where it is clear and nearer than 2 mm. `unsettled` counts ticks whose search for rest
ended on its way. `gap` is the farthest of the surface's points from the shell's, or from the spheres of `continuous`. `lost` counts fast approaches (50 to 1 000 mm/s, up to 20
rad/s) to 10 mm below the surface whose tool ends more than 5 mm below it: beside the bone, through a gap or through bone. Coupling 0.5 N/mm and 450 N mm/rad.

| tool | scheme | triangles | points | gap, mm | voxel, mm | set-up, s | ticks | touching | p50 | p99 | p99.9 | max | told, mm | deepest, mm | met, of judged | unfelt | unfelt deepest, mm | apart, mm | force, N | torque, N mm | unsettled | lost |
|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|
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
constexpr std::size_t judging_points = 20'000;
constexpr std::int64_t judged_every = 20;
constexpr double stroke = 10, lost_depth = 5;  // mm
constexpr double clear_within = 2;             // mm, up to which distances are compared

struct Row {
    std::string tool, scheme;
    std::size_t triangles = 0, points = 0, judged = 0, met = 0, unfelt = 0;
    double gap = 0, voxel = 0, set_up_s = 0, told = 0, deepest = 0, unfelt_deepest = 0, apart = 0, force = 0,
           torque = 0;
    std::int64_t ticks = 0, touching = 0, unsettled = 0, approaches = 0, lost = 0;
    realtime::Histogram times{};
};

Eigen::Isometry3d pose_in(const TickResult& result) {
    Eigen::Isometry3d X_PT = Eigen::Isometry3d::Identity();
    X_PT.linear() = quaternion_of(result.tool_orientation).toRotationMatrix();
    X_PT.translation() = vector_of(result.tool_position);
    return X_PT;
}

// How a pose is judged without the shell's own code.
class Judge {
  public:
    Judge(const TriangleMesh& bone, const collision::CollisionSurface& surface, const TriangleMesh& tool,
          std::span<const collision::ShellPoint> shell)
        : fcl_(bone, tool),
          surface_(surface),
          others_(collision::point_shell(tool, judging_points).points),
          shell_(shell) {}

    void judge(const TickResult& result, Row& row) const {
        const Eigen::Isometry3d X_PT = pose_in(result);
        ++row.judged;
        const double deep = -least_distance(others_, X_PT);
        row.deepest = std::max(row.deepest, deep);
        const bool felt = result.contact_count > 0;
        const double apart = fcl_.distance(X_PT);
        row.met += apart == 0;
        if (apart == 0 && !felt) {
            ++row.unfelt;
            row.unfelt_deepest = std::max(row.unfelt_deepest, deep);
        }
        if (!shell_.empty() && apart > 0 && apart < clear_within)
            row.apart = std::max(row.apart, std::abs(least_distance(shell_, X_PT) - apart));
    }

  private:
    // Signed, of the points; clear_within for all that are farther.
    double least_distance(std::span<const collision::ShellPoint> points,
                          const Eigen::Isometry3d& X_PT) const {
        double least = 2 * clear_within;
        std::int32_t hint = -1;
        for (const collision::ShellPoint& point : points) {
            const Vector3d p = X_PT * point.position.cast<double>();
            const auto nearest = surface_.closest_point(p, 2 * clear_within + stroke, hint);
            if (!nearest) continue;
            hint = nearest->slot;
            const bool outside = surface_.is_outside(p, *nearest);
            least = std::min(least, outside ? nearest->distance : -nearest->distance);
        }
        return least;
    }

    FclJudge fcl_;
    const collision::CollisionSurface& surface_;
    std::vector<collision::ShellPoint> others_;
    std::span<const collision::ShellPoint> shell_;
};

void press(HapticModel& model, const std::vector<ToolVisit>& visits, const Judge& judge, Row& row) {
    Shortest times;
    TickResult result{};
    for (int pass = 0; pass < Shortest::passes; ++pass) {
        std::size_t step = 0;
        for (const ToolVisit& visit : visits) {
            model.reset();
            devices::SimulatedDevice hand(visit.path, {});
            const auto ticks = static_cast<std::int64_t>(1000 * visit.path.duration());
            for (std::int64_t tick = 0; tick < ticks; ++tick) {
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
                if (tick % judged_every == 0 && !(result.status & starts_inside)) judge.judge(result, row);
            }
        }
    }
    row.times = times.histogram();
}

bool is_lost(HapticModel& model, const ToolVisit& visit, double reach) {
    model.reset();
    TickResult result{};
    devices::SimulatedDevice hand(visit.path, {});
    const auto ticks = static_cast<std::int64_t>(1000 * visit.path.duration());
    for (std::int64_t tick = 0; tick <= ticks; ++tick)
        model.tick(hand.read(1e-3 * static_cast<double>(tick)), result);
    return visit.place.direction.dot(vector_of(result.tool_position) - visit.place.entry) + reach >
           lost_depth;
}

double us(const Row& row, double share) {
    return 1e-3 * static_cast<double>(row.times.percentile(share));
}

Json json_of(const Row& row) {
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
            {"deepest_mm", row.deepest},
            {"judged", row.judged},
            {"met", row.met},
            {"unfelt", row.unfelt},
            {"unfelt_deepest_mm", row.unfelt_deepest},
            {"apart_mm", row.apart},
            {"force_max_n", row.force},
            {"torque_max_n_mm", row.torque},
            {"unsettled", row.unsettled},
            {"approaches", row.approaches},
            {"lost", row.lost}};
}

std::string row_of(const Row& row) {
    return fmt::format(
        "| {} | {} | {} | {} | {:.2f} | {:g} | {:.1f} | {} | {} | {:.1f} | {:.1f} | {:.1f} | {:.1f} | {:.3f} "
        "| "
        "{:.3f} | {} of {} | {} | {:.3f} | {:.3f} | {:.2f} | {:.0f} | {} | {} of {} |\n",
        row.tool, row.scheme, row.triangles, row.points, row.gap, row.voxel, row.set_up_s, row.ticks,
        row.touching, us(row, 0.5), us(row, 0.99), us(row, 0.999), us(row, 1), row.told, row.deepest, row.met,
        row.judged, row.unfelt, row.unfelt_deepest, row.apart, row.force, row.torque, row.unsettled, row.lost,
        row.approaches);
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
    const std::int64_t visits_wanted = options.seconds > 0 ? std::int64_t(options.seconds) : 60;
    const std::int64_t approaches = options.approaches > 0 ? options.approaches : 1000;
    Case bone = rigid_case("bone", meshing::read_surface(options.surfaces.front()), HapticSettings{});
    Findings findings;
    findings.table = fmt::format(method, Shortest::passes);
    for (const std::filesystem::path& file : options.tools)
        for (const auto& [scheme, points] : ways) {
            session.progress.step(file.stem().string(), 0);
            bone.tool = ToolBody{stl_file::read_stl(file), {.shell_points = points}};
            const std::int64_t begin = realtime::monotonic_ns();
            HapticModel model(bone, scheme);
            Row row;
            row.set_up_s = 1e-9 * static_cast<double>(realtime::monotonic_ns() - begin);
            row.tool = file.stem().string();
            row.scheme = scheme;
            row.triangles = bone.tool->surface.triangles.size();
            collision::PointShell shell;
            if (scheme == "continuous") {
                row.points = model.tool_spheres().size();
                row.gap = haptics::fill_with_spheres(bone.tool->surface, row.points).largest_gap;
            }
            if (scheme == "shell") {
                row.points = static_cast<std::size_t>(points);
                row.voxel = bone.tool->settings.voxel;
                shell = collision::point_shell(bone.tool->surface, row.points);
                row.gap = shell.covering_radius;
            }
            const Judge judge(bone.rigid_bodies[0].surface, model.surface(0), bone.tool->surface,
                              shell.points);
            std::mt19937_64 random(options.seed);
            const double reach = model.contact_radius();
            const auto places = draw_places(bone.rigid_bodies[0].surface, model.surface(0), 3,
                                            static_cast<std::size_t>(visits_wanted), random);
            std::vector<ToolVisit> visits;
            for (const Place& place : places) visits.push_back(pressing_visit(place, reach, random));
            press(model, visits, judge, row);
            session.progress.step(file.stem().string() + ", fast", 0.5);
            for (; row.approaches < approaches; ++row.approaches) {
                const Place& place = places[static_cast<std::size_t>(row.approaches) % places.size()];
                row.lost += is_lost(model, fast_visit(place, reach, stroke, random), reach);
            }
            findings.result["rows"].push_back(json_of(row));
            findings.table += row_of(row);
        }
    session.progress.finish();
    return findings;
}

}  // namespace palpate::experiments
