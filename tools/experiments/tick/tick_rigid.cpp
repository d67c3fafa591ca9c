// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/tick/tick_rigid.hpp"

#include <algorithm>
#include <array>
#include <optional>
#include <utility>

#include "tools/experiments/rigid_case.hpp"
#include "tools/experiments/tick/cgal_peer.hpp"
#include "tools/obb/build_obb_tree.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using Eigen::Vector3d;

struct Tool {
    const char* name;
    double radius;                 // mm
    double limit_p50, limit_p999;  // us
};
constexpr std::array tools{Tool{"point", 0.01, 0.4, 5}, Tool{"1 mm sphere", 1, 2, 15}};

std::vector<Vector3d> positions_of(const HandPath& path) {
    std::vector<Vector3d> positions;
    for (int ms = 0; 1e-3 * ms <= path.duration(); ++ms) positions.push_back(path.at(1e-3 * ms));
    return positions;
}

void add_queries(RigidTicks& found, const TriangleMesh& bone, const HandPath& path) {
    ObbTree tree;
    found.tree_s = 1e-9 * static_cast<double>(nanoseconds_of([&] { tree = obb::build_obb_tree(bone); }));
    std::optional<collision::CollisionSurface> surface;
    found.surface_s =
        1e-9 * static_cast<double>(nanoseconds_of([&] { surface.emplace(bone, tree, "bone"); }));
    const std::vector<Vector3d> positions = positions_of(path);
    Shortest closest, segment, sweep;
    std::int32_t hint = -1;
    for (int pass = 0; pass < Shortest::passes; ++pass)
        for (std::size_t i = 0; i < positions.size(); ++i) {
            const Vector3d &p = positions[i], &last = positions[std::max<std::size_t>(i, 1) - 1];
            closest.record(i, nanoseconds_of([&] {
                               if (const auto point = surface->closest_point(p, 1000, hint))
                                   hint = point->slot;
                           }));
            if (p == last) continue;
            segment.record(i, nanoseconds_of([&] { keep(surface->sweep_sphere(last, p, 0).has_value()); }));
            sweep.record(i, nanoseconds_of([&] { keep(surface->sweep_sphere(last, p, 1).has_value()); }));
        }
    const PeerTimes peer = time_cgal(bone, positions);
    found.cgal_tree_s = peer.build_s;
    found.cgal_closest = peer.closest;
    const auto add = [&](const char* name, const realtime::Histogram& times) {
        found.rows.push_back({.group = "query", .name = name, .times = times, .run = {}});
    };
    add("closest point", closest.histogram());
    add("closest point, CGAL", peer.closest);
    add("segment", segment.histogram());
    add("segment, CGAL", peer.segment);
    add("sweep of a 1 mm sphere", sweep.histogram());
}

}  // namespace

HapticSettings tick_settings(double tool_radius, bool friction) {
    return {.tool_radius = tool_radius,
            .coupling_stiffness = 0.5,
            .max_force = 3.3,
            .max_force_rate = 3.3,
            .friction_at_rest = friction ? 0.3 : 0.0,
            .friction_sliding = friction ? 0.2 : 0.0};
}

Case bone_case(const TriangleMesh& bone, double tool_radius, bool friction) {
    return rigid_case("bone", bone, tick_settings(tool_radius, friction));
}

RigidTicks rigid_ticks(const TriangleMesh& bone, const HandPath& path) {
    RigidTicks found;
    add_queries(found, bone, path);
    const std::span one(&path, 1);
    for (const std::string name : {"single", "twice"}) {
        haptics::HapticModel model(bone_case(bone, tools[0].radius, false), name);
        const TickRun run = time_ticks(model, one, Counted::all);
        found.rows.push_back({.group = "rigid", .name = name + ", point", .times = run.tick, .run = run});
        found.rows.push_back(
            {.group = "rigid", .name = name + ", collision loop", .times = run.detect, .run = {}});
    }
    for (const Tool& tool : tools)
        for (const bool friction : {false, true}) {
            haptics::HapticModel model(bone_case(bone, tool.radius, friction));
            found.below += ticks_below(model, path);
            const TickRun run = time_ticks(model, one, Counted::all);
            found.rows.push_back(
                {.group = "rigid",
                 .name = std::string("continuous, ") + tool.name + (friction ? ", friction" : ""),
                 .times = run.tick,
                 .run = run,
                 .limit_p50 = tool.limit_p50,
                 .limit_p999 = tool.limit_p999});
        }
    return found;
}

}  // namespace palpate::experiments
