// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/stability/stability.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <functional>
#include <optional>
#include <random>

#include "formats/asset/asset.hpp"
#include "formats/drawing/chart.hpp"
#include "formats/model/arrays.hpp"
#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "runtime/haptics/servo_loop.hpp"
#include "runtime/session/run_record.hpp"
#include "runtime/session/touch_target.hpp"
#include "tools/experiments/force_quality.hpp"

namespace palpate::experiments {
namespace {

using namespace devices;
using namespace haptics;
using namespace session;
using drawing::Chart;
using drawing::Series;

using Json = nlohmann::ordered_json;

constexpr std::string_view device_name = "desktop";  // the reference system's
constexpr std::array<std::string_view, 3> compared_schemes{"single", "twice", "continuous"};
constexpr std::array scheme_titles{"1 before (single)", "2 after (twice)", "3 continuous"};
constexpr double press_depth = 4;       // mm, of the tool's centre below the rest surface
constexpr double visit_s = 10;          // of the long run, at one place
constexpr double allowed_depth = 0.05;  // mm, of the tool's surface below the surface it touches

constexpr std::string_view stability_method =
    "One hand (0.3 N/mm, 2e-3 N s/mm) holds a simulated PHANTOM Desktop and presses, slides and leaves, in "
    "the "
    "closed loop at 1 kHz, on virtual time. It wants to be 4 mm below the surface at rest with the tool's "
    "centre, "
    "the published end-effector; the same way for every scheme. Before and after: before and behind the "
    "limiter. "
    "A jump is a step of force above 0.5 N per ms. A force pulls if a contact's, by more than 1e-6 N, is "
    "against "
    "the outward normals of all triangles that hold the contact's point (on a rigid body with a sphere: of "
    "all "
    "that it touches). Roughness is the RMS of dF/dt. Work "
    "is "
    "that of the device on the tip, positive when the hand receives it; an episode lasts while force lasts. "
    "A "
    "spring of the coupling's stiffness K that is read every tick to a grain q and held until the next gives "
    "at "
    "most K |dx| (|dx|/2 + sqrt(3) q) a tick more than it took: the bound, which an episode exceeds if the "
    "work "
    "since its begin is above it at any tick.\n\n";
constexpr std::string_view curve_head =
    "| case | body | scheme | jumps before | largest step, N | roughness, N/s | jumps after | largest step, "
    "N | "
    "roughness, N/s | pulling ticks | strongest pull, N | work, N mm | most given in an episode, N mm | "
    "episodes "
    "over the bound | by at most, N mm |\n"
    "|---|---|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";
constexpr std::array frictions{0.0, 0.4};  // at rest and sliding alike
constexpr double lost_depth = 0.1;         // mm

constexpr std::string_view long_text =
    "\nRandom pushing, sliding and leaving with `continuous`: visits to random places of all bodies, up to "
    "100 mm/s, as deep as above, without friction and with it. Force is lost in a tick if there is none "
    "though the device has its tool more than 0.1 mm below a body's surface at rest, edges being round, and "
    "no fault takes it away.\n\n";
constexpr std::string_view long_head =
    "| case | friction | visits, s | touching, s | force lost, ticks | not finite | above the limit | "
    "pulling ticks | strongest pull, N | tool inside, mm | visits deeper than 0.05 mm | work, N mm | "
    "bound, N mm | most given in an episode, N mm | episodes over the bound | by at most, N mm |\n"
    "|---|--:|---|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|--:|\n";

// One way of touching, measured.
struct Run {
    ForceFigures figures;
    Series curve;
};

// A hand that follows `path`, in the closed loop with the device; the model starts afresh.
void touch(HapticModel& model, HandPath path, double seconds, ForceQuality& quality,
           const std::function<void(const TickResult&)>& sink) {
    model.reset();
    DynamicDevice device(find_device_model(device_name), HandImpedance{}, std::move(path));
    ServoLoop loop(model, device);
    quality.begin_run();
    loop.run_virtual(static_cast<std::int64_t>(1000 * seconds), [&](const TickResult& result) {
        quality.add(result, device.position());
        sink(result);
    });
}

ForceQuality::Passivity passivity_of(const HapticModel& model) {
    const DeviceModel& device = find_device_model(device_name);
    const DeviceLimits limits{device.max_force, device.max_stiffness, device.damping};
    return {coupling_stiffness(model.settings(), limits), device.encoder_resolution};
}

// Presses twice, slides, leaves. The published method's end-effector is a point, so depth counts from the
// tool's centre, for all schemes alike.
HandPath press_slide_leave(const TouchPoint& place, double tool_radius) {
    ScriptSettings settings{.tool_radius = tool_radius, .depth = tool_radius + press_depth, .speed = 20};
    settings.seconds = 2;
    const HandPath press = press_path(place, settings);
    settings.seconds = 6;
    const HandPath slide = slide_path(place, settings);
    std::vector<HandPath::Key> keys;
    const double whole = press.duration() + slide.duration();
    for (int ms = 0; 1e-3 * ms < whole; ++ms) {
        const double t = 1e-3 * ms;
        keys.push_back({t, t < press.duration() ? press.at(t) : slide.at(t - press.duration())});
    }
    return HandPath(std::move(keys));
}

Run run_scheme(const Case& patient_case, const RestNormals& normals, std::size_t scheme,
               const TouchTarget& target) {
    HapticModel model(patient_case, compared_schemes[scheme]);
    ForceQuality quality(normals, model, passivity_of(model));
    Run run;
    run.curve.name = scheme_titles[scheme];
    const HandPath path = press_slide_leave(target.place, model.settings().tool_radius);
    const Eigen::Vector3d outwards = target.place.normal;
    touch(model, path, path.duration() + 0.5, quality, [&](const TickResult& result) {
        run.curve.x.push_back(result.time);
        run.curve.y.push_back(outwards.dot(Eigen::Map<const Eigen::Vector3d>(result.force.data())));
    });
    run.figures = quality.figures();
    return run;
}

Json figures_json(const ForceFigures& q) {
    const auto steps = [&](const ForceFigures::Steps& s) {
        return Json{{"jumps", s.jumps}, {"largest_step_n", s.largest}, {"roughness_n_per_s", s.roughness()}};
    };
    return {{"ticks", q.ticks},
            {"touching_ticks", q.touching_ticks},
            {"before_limiter", steps(q.wanted)},
            {"after_limiter", steps(q.rendered)},
            {"pulling_ticks", q.pulling_ticks},
            {"strongest_pull_n", q.strongest_pull},
            {"energy",
             {{"given_n_mm", q.given},
              {"most_given_in_an_episode_n_mm", q.most_given},
              {"sampling_bound_n_mm", q.bound},
              {"episodes", q.episodes},
              {"episodes_over_bound", q.over_bound},
              {"worst_over_bound_n_mm", q.worst_over_bound}}}};
}

std::string figures_row(const ForceFigures& q) {
    return fmt::format(
        "{} | {:.2f} | {:.0f} | {} | {:.2f} | {:.0f} | {} | {:.2g} | {:.2f} | {:.3f} | {} of {} | {:.3f} |\n",
        q.wanted.jumps, q.wanted.largest, q.wanted.roughness(), q.rendered.jumps, q.rendered.largest,
        q.rendered.roughness(), q.pulling_ticks, q.strongest_pull, q.given, q.most_given, q.over_bound,
        q.episodes, q.worst_over_bound);
}

// Curves and numbers of the three schemes, on one body of either kind.
struct Comparison {
    Json json = Json::array();
    std::string rows;
    std::vector<Chart> charts;
};

Comparison compare_schemes(const Case& patient_case, const RestNormals& normals) {
    const HapticModel model(patient_case);
    std::vector<std::string> bodies;
    if (model.rigid_count() > 0) bodies.push_back(model.body_name(0));
    if (model.rigid_count() < model.body_count()) bodies.push_back(model.body_name(model.rigid_count()));
    Comparison comparison;
    for (const std::string& body : bodies) {
        const TouchTarget target = choose_touch_target(patient_case, model, body, std::nullopt);
        Chart& chart = comparison.charts.emplace_back();
        chart.title = patient_case.name + ": " + body;
        chart.x_label = "time, s";
        chart.y_label = "force outwards, N";
        for (std::size_t scheme = 0; scheme < compared_schemes.size(); ++scheme) {
            Run run = run_scheme(patient_case, normals, scheme, target);
            const std::string_view name = compared_schemes[scheme];
            comparison.rows +=
                fmt::format("| {} | {} | {} | ", patient_case.name, body, name) + figures_row(run.figures);
            Json entry{{"case", patient_case.name}, {"body", body}, {"scheme", name}};
            entry.update(figures_json(run.figures));
            comparison.json.push_back(std::move(entry));
            chart.series.push_back(std::move(run.curve));
        }
    }
    return comparison;
}

// A place where the tool fits, on any body with equal chance.
TouchTarget random_place(const Case& patient_case, const HapticModel& model, std::mt19937_64& random) {
    constexpr int attempts = 1000;
    for (int attempt = 1;; ++attempt) {
        const std::size_t body = random() % model.body_count();
        const collision::CollisionSurface& surface = model.surface(body);
        const auto slot =
            static_cast<std::int32_t>(random() % static_cast<std::uint64_t>(surface.triangle_count()));
        const collision::TriangleCorners t = surface.corners(slot);
        try {
            return choose_touch_target(patient_case, model, model.body_name(body), (t[0] + t[1] + t[2]) / 3);
        } catch (const InvalidInput&) {
            if (attempt == attempts) throw;
        }
    }
}

// Whether a ball at p (mm), of `radius`, is more than lost_depth below what it feels of a body at rest.
bool is_below_a_surface(const HapticModel& model, const Eigen::Vector3d& p, double radius) {
    constexpr double deepest = 20;  // mm
    for (std::size_t body = 0; body < model.body_count(); ++body) {
        const auto nearest = model.surface(body).closest_point(p, deepest);
        if (!nearest) continue;
        const bool outside = model.surface(body).is_outside(p, *nearest);
        const double height = outside ? nearest->distance : -nearest->distance;
        if (height < radius - lost_depth - model.cut_off(body, *nearest)) return true;
    }
    return false;
}

// Force that a hand should feel and does not.
bool is_force_lost(const HapticModel& model, const TickResult& result) {
    return result.contact_count == 0 && result.faults == no_fault && (result.status & starts_inside) == 0 &&
           is_below_a_surface(model, vector_of(result.device_position), model.settings().tool_radius);
}

struct LongRun {
    double friction = 0;
    ForceFigures figures;
    std::int64_t visits = 0, visits_inside = 0, not_finite = 0, above_limit = 0, lost = 0;
    double strongest = 0, deepest = 0;
};

LongRun push_at_random(Case patient_case, double friction, const RestNormals& normals, double seconds,
                       std::uint64_t seed, cli::Session& session) {
    patient_case.haptics.friction_at_rest = patient_case.haptics.friction_sliding = friction;
    HapticModel model(patient_case);
    ForceQuality quality(normals, model, passivity_of(model));
    LongRun run{.friction = friction, .figures = {}};
    std::mt19937_64 random(seed);
    const double radius = model.settings().tool_radius;
    const ScriptSettings settings{.tool_radius = radius,
                                  .depth = radius + press_depth,
                                  .speed = 100,
                                  .hold_s = 0.3,
                                  .slide_length = 8,
                                  .seconds = visit_s};
    for (double done = 0; done < seconds; done += visit_s, ++run.visits) {
        session.progress.step(patient_case.name + ": random", done / seconds);
        const TouchTarget target = random_place(patient_case, model, random);
        RunRecord record(model, nullptr);
        touch(model, random_path(target.place, settings, random()), visit_s, quality,
              [&](const TickResult& result) {
                  const double force = Eigen::Map<const Eigen::Vector3d>(result.force.data()).norm();
                  run.lost += is_force_lost(model, result);
                  run.not_finite += !std::isfinite(force);
                  run.above_limit += force > model.settings().max_force * (1 + 1e-12);
                  run.strongest = std::max(run.strongest, force);
                  record.add(result);
              });
        run.visits_inside += record.tool_depth() > allowed_depth;
        run.deepest = std::max(run.deepest, record.tool_depth());
    }
    run.figures = quality.figures();
    return run;
}

Json long_run_json(const Case& patient_case, const LongRun& run) {
    Json json{{"case", patient_case.name},
              {"friction", run.friction},
              {"visits", run.visits},
              {"visit_s", visit_s},
              {"force_lost_ticks", run.lost},
              {"not_finite_ticks", run.not_finite},
              {"above_limit_ticks", run.above_limit},
              {"strongest_n", run.strongest},
              {"tool_depth_mm", run.deepest},
              {"visits_deeper_than_0.05_mm", run.visits_inside}};
    json.update(figures_json(run.figures));
    return json;
}

std::string long_run_row(const Case& patient_case, const LongRun& run) {
    const ForceFigures& q = run.figures;
    return fmt::format(
        "| {} | {:g} | {} x {:.0f} | {:.0f} | {} | {} | {} | {} | {:.2g} | {:.4f} | {} | {:.1f} | {:.1f} | "
        "{:.3f} | {} "
        "of {} "
        "| {:.3f} |\n",
        patient_case.name, run.friction, run.visits, visit_s, 1e-3 * static_cast<double>(q.touching_ticks),
        run.lost, run.not_finite, run.above_limit, q.pulling_ticks, q.strongest_pull, run.deepest,
        run.visits_inside, q.given, q.bound, q.most_given, q.over_bound, q.episodes, q.worst_over_bound);
}

}  // namespace

Findings stability(const Options& options, cli::Session& session) {
    if (options.cases.empty()) throw UsageError({"--case", "none is given", "one asset or more", ""});
    const double seconds = options.seconds > 0 ? options.seconds : 600;
    Findings findings;
    Json curves = Json::array(), long_runs = Json::array();
    std::string curve_rows, long_rows;
    for (const auto& file : options.cases) {
        const Case patient_case = asset::read_asset(file);
        const RestNormals normals(patient_case);
        Comparison comparison = compare_schemes(patient_case, normals);
        curves.insert(curves.end(), comparison.json.begin(), comparison.json.end());
        curve_rows += comparison.rows;
        findings.pictures.emplace_back("stability_" + patient_case.name,
                                       drawing::charts_svg(comparison.charts));
        for (const double friction : frictions) {
            const LongRun run =
                push_at_random(patient_case, friction, normals, seconds, options.seed, session);
            long_runs.push_back(long_run_json(patient_case, run));
            long_rows += long_run_row(patient_case, run);
        }
    }
    session.progress.finish();
    findings.result = {
        {"device", device_name}, {"seed", options.seed}, {"curves", curves}, {"random", long_runs}};
    findings.table = std::string(stability_method) + std::string(curve_head) + curve_rows +
                     std::string(long_text) + std::string(long_head) + long_rows;
    return findings;
}

}  // namespace palpate::experiments
