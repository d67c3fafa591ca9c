// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/tick/tick_soft.hpp"

#include <array>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "runtime/session/touch_target.hpp"
#include "tools/experiments/soft_ellipsoid.hpp"
#include "tools/experiments/tick/tick_rigid.hpp"
#include "tools/obb/build_obb_tree.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using namespace haptics;
using Eigen::Vector3d;

const Vector3d semi_axes(30, 30, 20);              // mm
constexpr std::array spacings{4.0, 2.8, 1.95};     // mm
constexpr std::array wanted_nodes{8, 16, 32, 64};  // loaded
constexpr double relative_depth = 0.5;             // of the tool's surface, in its radii
constexpr int fixed_limit_nodes = 16;
constexpr double period_us = 1000;
constexpr double small_radius = 5;   // mm: of the tool beside pairs
constexpr double pairs_limit = 150;  // us

// On the ellipsoid, x mm beside its top; slides go along y.
TouchPoint place_at(double x) {
    const double z = semi_axes.z() * std::sqrt(1 - std::pow(x / semi_axes.x(), 2));
    const Vector3d point(x, 0, z);
    return {.point = point,
            .normal = point.cwiseQuotient(semi_axes.cwiseAbs2()).normalized(),
            .tangent = Vector3d::UnitY()};
}

HandPath slide_at(double x, double radius, double depth, double seconds) {
    return slide_path(
        place_at(x),
        {.tool_radius = radius, .depth = depth, .speed = 10, .slide_length = 4, .seconds = seconds});
}

Case soft_case(const DeformableBody& body, double radius, bool friction) {
    Case made;
    made.name = "ellipsoid";
    made.deformable_bodies.push_back(body);
    made.haptics = tick_settings(radius, friction);
    return made;
}

TickRun run_of(HapticModel& model, double radius, double seconds) {
    const HandPath path = slide_at(0, radius, relative_depth * radius, seconds);
    return time_ticks(model, {&path, 1}, Counted::touching);
}

// The radius with which about so many nodes are loaded: their number grows with its square. Nothing if the
// tool would be larger than the body.
std::optional<double> radius_for(const DeformableBody& body, double spacing, int loaded) {
    const double largest = semi_axes.x();
    double radius = 0.8 * spacing * std::sqrt(loaded);
    for (int attempt = 0; attempt < 3; ++attempt) {
        radius = std::min(radius, largest);
        HapticModel model(soft_case(body, radius, false));
        radius *= std::sqrt(loaded / std::max(1.0, run_of(model, radius, 1).loaded));
    }
    return radius < largest ? std::optional(radius) : std::nullopt;
}

TickRow row_of(std::string name, const TickRun& run, std::size_t nodes, int loaded) {
    TickRow row{.group = "soft", .name = std::move(name), .times = run.tick, .run = run};
    if (nodes > 1500 && loaded == fixed_limit_nodes) {
        row.limit_p50 = 10;
        row.limit_p999 = 30;
    } else if (loaded > fixed_limit_nodes) {
        row.limit_p999 = period_us;
    }
    return row;
}

// The same body elsewhere.
DeformableBody moved(DeformableBody body, const Vector3d& by) {
    for (Vector3d& p : body.mesh.rest_positions) p += by;
    for (Vector3d& p : body.boundary.surface.vertices) p += by;
    body.obb_tree = obb::build_obb_tree(body.boundary.surface);
    return body;
}

// A sphere pushes the ellipsoid's end so that its other end presses a second one, which it overlaps at rest
// as organs cut from one label map do: with as many pairs as a tick solves.
TickRow neighbour_row(const DeformableBody& body, double radius, double seconds) {
    constexpr double overlap = 4, depth = 8;  // mm
    Case made = soft_case(body, radius, false);
    made.deformable_bodies.push_back(moved(body, Vector3d(2 * semi_axes.x() - overlap, 0, 0)));
    made.deformable_bodies[1].name = "neighbour";
    HapticModel model(made);
    const TouchPoint place{
        .point = {-semi_axes.x(), 0, 0}, .normal = -Vector3d::UnitX(), .tangent = Vector3d::UnitY()};
    const HandPath path = slide_path(
        place, {.tool_radius = radius, .depth = depth, .speed = 10, .slide_length = 4, .seconds = seconds});
    const TickRun run = time_ticks(model, {&path, 1}, Counted::touching);
    TickRow row = row_of(fmt::format("continuous, {} and {} nodes, {:.1f} mm sphere, {:.0f} pairs that press",
                                     body.contact_nodes.size(), body.contact_nodes.size(), radius, run.pairs),
                         run, 0, 0);
    row.limit_p999 = pairs_limit;
    return row;
}

}  // namespace

SoftTicks soft_ticks(cli::Session& session) {
    constexpr double seconds = 3;
    std::vector<TickRow> rows, others;
    std::vector<SoftTicks::Point> points;
    std::optional<SoftTouchCase> loaded;
    for (const double spacing : spacings) {
        session.progress.step(fmt::format("soft body, nodes {} mm apart", spacing), 0.4);
        const DeformableBody body = body_of({semi_axes, spacing, 0.45, -1});
        const std::size_t nodes = body.contact_nodes.size();
        for (const int loaded_nodes : wanted_nodes) {
            const auto found = radius_for(body, spacing, loaded_nodes);
            if (!found) break;
            const double radius = *found;
            const std::string what = fmt::format("{} nodes, {:.1f} mm sphere", nodes, radius);
            for (const bool friction : {false, true}) {
                HapticModel model(soft_case(body, radius, friction));
                const TickRun run = run_of(model, radius, seconds);
                rows.push_back(
                    row_of("continuous, " + what + (friction ? ", friction" : ""), run, nodes, loaded_nodes));
                const auto us = [&](double fraction) {
                    return 1e-3 * static_cast<double>(run.tick.percentile(fraction));
                };
                if (!friction) points.push_back({nodes, run.loaded, us(0.5), us(0.999)});
            }
            if (spacing != spacings.back() || loaded_nodes != fixed_limit_nodes) continue;
            loaded = SoftTouchCase{soft_case(body, radius, false), loaded_nodes,
                                   slide_at(0, radius, relative_depth * radius, 5)};
            for (const std::string name : {"single", "twice"}) {
                HapticModel model(loaded->patient_case, name);
                const HandPath path = slide_at(0, 0, relative_depth * radius, seconds);
                const TickRun run = time_ticks(model, {&path, 1}, Counted::touching);
                others.push_back(row_of(fmt::format("{}, {} nodes, point", name, nodes), run, 0, 0));
                others.push_back(
                    {.group = "soft", .name = name + ", collision loop", .times = run.detect, .run = {}});
            }
            HapticModel model(loaded->patient_case, usual_contact_method, 2);
            const std::array paths{slide_at(-10, radius, relative_depth * radius, seconds),
                                   slide_at(10, radius, relative_depth * radius, seconds)};
            others.push_back(neighbour_row(body, small_radius, seconds));
            others.push_back(
                row_of("continuous, two tools, " + what, time_ticks(model, paths, Counted::touching), 0, 0));
        }
    }
    rows.insert(rows.end(), others.begin(), others.end());
    return {std::move(rows), std::move(points), std::move(*loaded)};
}

TickRow case_ticks(const Case& patient_case) {
    HapticModel model(patient_case);
    const session::TouchTarget target = session::choose_touch_target(patient_case, model, "", std::nullopt);
    const HandPath path =
        slide_path(target.place, {.tool_radius = model.settings().tool_radius, .depth = 3, .speed = 10});
    return row_of("continuous, " + patient_case.name + ", " + model.body_name(target.body),
                  time_ticks(model, {&path, 1}, Counted::touching), 0, 0);
}

}  // namespace palpate::experiments
