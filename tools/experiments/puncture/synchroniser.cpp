// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/puncture/synchroniser.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <optional>

#include "formats/model/arrays.hpp"
#include "tools/experiments/soft_ellipsoid.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using drawing::Chart;
using drawing::Series;
using Eigen::Vector3d;
using Json = nlohmann::ordered_json;

constexpr double touch_tick_s = 1e-3;
constexpr int touches = 30;  // as many phases of the collision loop
constexpr ScriptSettings touch_script{.tool_radius = 0, .depth = 4, .speed = 40, .seconds = 2};
const Ellipsoid soft_shape{{30, 30, 20}, 5, 0.45, -1};

std::string_view name_of(Crossing crossing) {
    return crossing == Crossing::late ? "late" : "synchronised";
}

// A body and where it is touched.
struct Touched {
    std::string name;
    const Case& patient_case;
    TouchPoint point;
};

SynchroniserRun::Row mean_row(const Touched& body, std::string_view scheme, Crossing crossing,
                              const DeviceModel& device, Series& curve) {
    haptics::HapticModel model(body.patient_case, scheme);
    const DeviceLimits limits = limits_of(device);
    model.couple_to({&limits, 1});
    SynchroniserRun::Row row{.body = body.name, .scheme = scheme, .crossing = crossing};
    const HandPath path = slide_path(body.point, touch_script);
    for (int i = 0; i < touches; ++i) {
        const TouchFigures touch =
            touch_published(model, device, path, body.point.normal, (i + 0.5) / touches, crossing);
        row.largest_step += touch.largest_step / touches;
        row.roughness += touch.roughness / touches;
        row.pull += touch.pull / touches;
        if (i > 0) continue;
        for (std::size_t tick = 0; tick < touch.force.size(); ++tick) {
            curve.x.push_back(touch_tick_s * static_cast<double>(tick));
            curve.y.push_back(touch.force[tick]);
        }
    }
    return row;
}

void compare(SynchroniserRun& run, const Touched& body, const std::string& figure,
             const DeviceModel& device) {
    Chart& chart = run.charts.emplace_back();
    chart.title = fmt::format("{}: before and after, as figure {}", body.name, figure);
    chart.x_label = "time [s]";
    chart.y_label = "force outwards [N]";
    for (const std::string_view scheme : {"single", "twice"})
        for (const Crossing crossing : {Crossing::late, Crossing::synchronised}) {
            Series curve;
            run.rows.push_back(mean_row(body, scheme, crossing, device, curve));
            const bool before = scheme == "single" && crossing == Crossing::late,
                       after = scheme == "twice" && crossing == Crossing::synchronised;
            if (!before && !after) continue;
            curve.name = fmt::format("{}: {}, {}", before ? "1" : "2", scheme, name_of(crossing));
            chart.series.push_back(std::move(curve));
        }
}

}  // namespace

TouchFigures touch_published(haptics::HapticModel& model, const DeviceModel& device_model,
                             const HandPath& path, const Vector3d& outwards, double phase,
                             Crossing crossing) {
    model.reset();
    DynamicDevice device(device_model, HandImpedance{}, path);
    TouchFigures figures;
    TickResult result{}, seen{};  // of the tick, and of the loop's turn before
    bool has_seen = false;
    Vector3d last = Vector3d::Zero();
    double squared_steps = 0;
    int felt = 0;
    const auto ticks = static_cast<int>(std::ceil(path.duration() / touch_tick_s));
    for (int tick = 0; tick <= ticks; ++tick) {
        const double time = touch_tick_s * tick;
        model.tick(device.read(time), result);
        device.write({result.force});
        if (detects_at(time, phase)) {
            if (crossing == Crossing::synchronised) seen = result;
            if (crossing == Crossing::synchronised || has_seen)
                model.detect_at(seen.device_position, seen.tick);
            seen = result;
            has_seen = true;
        }
        const Vector3d force = vector_of(result.force);
        const double step = (force - last).norm();
        if (figures.first_force_s < 0 && !force.isZero(0)) figures.first_force_s = time;
        if (step > 0 || !force.isZero(0)) {
            squared_steps += step * step;
            ++felt;
        }
        figures.largest_step = std::max(figures.largest_step, step);
        figures.pull = std::max(figures.pull, -force.dot(outwards));
        figures.force.push_back(force.dot(outwards));
        last = force;
    }
    if (felt > 0) figures.roughness = std::sqrt(squared_steps / felt) / touch_tick_s;
    return figures;
}

SynchroniserRun compare_synchronisers(const Case& bone, const Place& place, const DeviceModel& device) {
    SynchroniserRun run;
    compare(run,
            {"bone",
             bone,
             {.point = place.entry,
              .normal = -place.direction,
              .tangent = place.direction.unitOrthogonal(),
              .clearance = Place::free_way}},
            "6", device);
    Case soft;
    soft.name = "soft";
    soft.deformable_bodies = {body_of(soft_shape)};
    soft.haptics = approach_settings;
    compare(run,
            {"soft tissue",
             soft,
             {.point = {0, 0, soft_shape.semi_axes.z()},
              .normal = Vector3d::UnitZ(),
              .tangent = Vector3d::UnitX(),
              .clearance = Place::free_way}},
            "8", device);
    return run;
}

Json add_synchroniser_table(std::string& table, const SynchroniserRun& run) {
    table += fmt::format(
        "\n## Synchroniser\n\n"
        "Before, the answer of the collision loop crosses to the servo with the visual loop's next turn, a "
        "thirtieth of a second late and of a position as old; synchronised, at once. A hand presses {:g} mm "
        "deep at {:g} mm/s, slides and leaves, {} times with as many phases of the loop, on the thickest "
        "wall "
        "of the bone above (figure 6) and on an ellipsoid of 3 kPa (figure 8). Means over the touches.\n\n"
        "| body | scheme | answers | largest step, N/ms | roughness, N/s | strongest pull, N |\n"
        "|:--|:--|:--|--:|--:|--:|\n",
        touch_script.depth, touch_script.speed, touches);
    Json rows = Json::array();
    for (const SynchroniserRun::Row& row : run.rows) {
        table += fmt::format("| {} | `{}` | {} | {:.3f} | {:.1f} | {:.3f} |\n", row.body, row.scheme,
                             name_of(row.crossing), row.largest_step, row.roughness, row.pull);
        rows.push_back({{"body", row.body},
                        {"scheme", row.scheme},
                        {"answers", name_of(row.crossing)},
                        {"largest_step_n", row.largest_step},
                        {"roughness_n_per_s", row.roughness},
                        {"pull_n", row.pull}});
    }
    return rows;
}

}  // namespace palpate::experiments
