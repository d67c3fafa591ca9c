// SPDX-License-Identifier: Apache-2.0
#include "runtime/training/lay_out.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <numbers>
#include <random>

#include "formats/model/arrays.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/regions.hpp"
#include "runtime/session/jaws/grasp_place.hpp"
#include "runtime/training/region_outline.hpp"

namespace palpate::training {
namespace {

using devices::TouchPoint;
using Eigen::Vector3d;
using haptics::HapticModel;
using session::TouchTarget;

constexpr double least_depth = 1, most_depth = 4;  // mm
constexpr double seen = 0.4;                       // least cosine between normals of places on one side
// Least cosine between a triangle's normal and that of the surface around a place: 26 degrees, no edge.
constexpr double smooth = 0.9;
constexpr double room = 3;                           // mm that the tool needs to come to a mark
constexpr double least_hold = 0.005, most_pull = 1;  // N: of a forceps

std::vector<std::int32_t> free_vertices(const Case& patient_case, std::size_t body) {
    const TriangleMesh& surface = session::surface_of(patient_case, body);
    std::vector<std::int32_t> vertices;
    for (const std::int32_t triangle : session::free_triangles(patient_case, body))
        vertices.insert(vertices.end(), surface.triangles[triangle].begin(),
                        surface.triangles[triangle].end());
    std::ranges::sort(vertices);
    vertices.erase(std::unique(vertices.begin(), vertices.end()), vertices.end());
    return vertices;
}

// The surface vertex where a region changes the stiffness most, if the case says so.
std::optional<std::int32_t> felt_vertex(const DeformableBody& body, const std::string& region) {
    if (!body.feel) return std::nullopt;
    for (const FeltRegion& felt : body.feel->regions)
        for (const Label& label : body.mesh.region_names)
            if (label.value == felt.region && label.name == region) return felt.vertex;
    return std::nullopt;
}

const DeformableBody& soft_body(const Case& patient_case, std::size_t body) {
    return patient_case.deformable_bodies[body - patient_case.rigid_bodies.size()];
}

HiddenRegion hidden_region(const Case& patient_case, std::size_t body, const Label& label) {
    const DeformableBody& soft = soft_body(patient_case, body);
    const std::vector<std::int32_t> nodes = nodes_of_region(soft.mesh, label.value);
    const auto& vertices = soft.boundary.surface.vertices;
    std::optional<std::int32_t> near = felt_vertex(soft, label.name);
    if (!near) {
        Vector3d middle = Vector3d::Zero();
        for (const std::int32_t node : nodes) middle += soft.mesh.rest_positions[node];
        middle /= static_cast<double>(nodes.size());
        const auto free = free_vertices(patient_case, body);
        near = *std::ranges::min_element(
            free, {}, [&](std::int32_t vertex) { return (vertices[vertex] - middle).norm(); });
    }
    HiddenRegion region{.name = label.name,
                        .body = body,
                        .label = label.value,
                        .above = place_above(soft, label.value, vertices[*near])};
    region.depth = std::numeric_limits<double>::max();
    for (const std::int32_t node : nodes)
        region.depth = std::min(region.depth, (soft.mesh.rest_positions[node] - region.above).norm());
    return region;
}

std::optional<HiddenRegion> region_of(const ExerciseRecipe& recipe, const Case& patient_case) {
    const std::vector<HiddenRegion> regions = hidden_regions(patient_case);
    if (recipe.region.empty()) return regions.empty() ? std::nullopt : std::optional(regions.front());
    std::vector<std::string> names;
    for (const HiddenRegion& region : regions) {
        if (region.name == recipe.region) return region;
        names.push_back(region.name);
    }
    throw InvalidInput({recipe.written_at, "the case hides no region '" + recipe.region + "'", "",
                        names.empty() ? "no body of it has more than one region"
                                      : fmt::format("it hides '{}'", fmt::join(names, "', '"))});
}

// Places of the start's body that are on its side, in an order that the seed draws.
std::vector<Vector3d> places_around(const Case& patient_case, const TouchTarget& start, double spread,
                                    std::uint64_t seed) {
    std::vector<Vector3d> places;
    const TriangleMesh& surface = session::surface_of(patient_case, start.body);
    for (const std::int32_t vertex : free_vertices(patient_case, start.body))
        if ((surface.vertices[vertex] - start.place.point).norm() <= spread)
            places.push_back(surface.vertices[vertex]);
    std::mt19937_64 random(seed);
    for (std::size_t i = places.size(); i > 1; --i) std::swap(places[i - 1], places[random() % i]);
    return places;
}

// The place itself, if the tool comes to it from the side on which `normal` stands and it is not on an edge.
std::optional<TouchTarget> reached(const Case& patient_case, const HapticModel& model, std::size_t body,
                                   const Vector3d& place, const Vector3d& normal) {
    auto target = session::touch_target_near(patient_case, model, body, place);
    if (!target || target->place.clearance < room || target->place.normal.dot(normal) < seen)
        return std::nullopt;
    const Vector3d around = model.surface(body).pseudonormal(target->place.point);
    if (around.dot(target->place.normal) < smooth) return std::nullopt;
    return target;
}

// Whether a place faces an eye and nothing stands between.
bool is_seen(const HapticModel& model, const TouchPoint& place, const FirstEye& eye) {
    constexpr double facing = 0.5;              // least cosine: 60 degrees
    constexpr double off = 1, thickness = 0.2;  // mm, of the line of sight: where it begins, its radius
    if (place.normal.dot((eye.place - place.point).normalized()) < facing) return false;
    if (eye.cuts) return true;
    const Vector3d begin = place.point + off * place.normal;
    for (std::size_t body = 0; body < model.body_count(); ++body)
        if (model.surface(body).sweep_sphere(begin, eye.place, thickness)) return false;
    return true;
}

// A place of the start's body that the tool reaches on the start's side, seen by the eye if there is one.
std::optional<TouchTarget> reached_in_sight(const Case& patient_case, const HapticModel& model,
                                            const TouchTarget& start, const Vector3d& place,
                                            const std::optional<FirstEye>& eye) {
    auto target = reached(patient_case, model, start.body, place, start.place.normal);
    return target && eye && !is_seen(model, target->place, *eye) ? std::nullopt : target;
}

// Fewer than are wanted where there is no room.
std::vector<Vector3d> marks_in_sight(const ExerciseRecipe& recipe, const Case& patient_case,
                                     const HapticModel& model, const TouchTarget& start, double apart,
                                     const std::optional<FirstEye>& eye) {
    const std::vector<Vector3d> candidates = places_around(patient_case, start, recipe.spread, recipe.seed);
    const auto wanted = static_cast<std::size_t>(recipe.count);
    // As far apart as the surface lets them be.
    for (double distance = recipe.spread; distance >= apart; distance *= 0.8) {
        std::vector<Vector3d> marks;
        for (const Vector3d& candidate : candidates) {
            const bool clear = std::ranges::all_of(
                marks, [&](const Vector3d& mark) { return (mark - candidate).norm() >= distance; });
            if (clear && reached_in_sight(patient_case, model, start, candidate, eye))
                marks.push_back(candidate);
            if (marks.size() == wanted) return marks;
        }
    }
    return {};
}

std::vector<Vector3d> draw_marks(const ExerciseRecipe& recipe, const Case& patient_case,
                                 const HapticModel& model, const TouchTarget& start, double apart,
                                 const FirstEye& eye) {
    for (const std::optional<FirstEye>& seen_by : {std::optional(eye), std::optional<FirstEye>()})
        if (auto marks = marks_in_sight(recipe, patient_case, model, start, apart, seen_by); !marks.empty())
            return marks;
    throw InvalidInput(
        {recipe.written_at.empty() ? recipe.name : recipe.written_at,
         fmt::format("{} marks find no room within {} mm of the start", recipe.count, recipe.spread), "",
         "ask for fewer ('count'), a wider 'spread_mm', or write 'places_mm'"});
}

// The place nearest to the one above a region, on its side, that the tool reaches.
std::optional<TouchTarget> reached_nearest(const Case& patient_case, const HapticModel& model,
                                           const HiddenRegion& region) {
    const TriangleMesh& surface = session::surface_of(patient_case, region.body);
    const Vector3d outward = model.surface(region.body).pseudonormal(region.above);
    std::vector<std::int32_t> vertices = free_vertices(patient_case, region.body);
    std::ranges::sort(vertices, {}, [&](std::int32_t vertex) {
        return (surface.vertices[vertex] - region.above).squaredNorm();
    });
    for (const std::int32_t vertex : vertices)
        if (auto target = reached(patient_case, model, region.body, surface.vertices[vertex], outward))
            return target;
    return std::nullopt;
}

// Whether the tool goes straight from over one place to over another.
bool is_clear_between(const HapticModel& model, const TouchTarget& from, const TouchTarget& to) {
    const double radius = model.settings().tool_radius;
    const Vector3d a = session::start_outside(from.place, radius),
                   b = session::start_outside(to.place, radius);
    for (std::size_t body = 0; body < model.body_count(); ++body)
        if (model.surface(body).sweep_sphere(a, b, radius)) return false;
    return true;
}

// Along the surface from the start, step by step, as long as the tool comes there.
std::vector<Vector3d> walk(const Case& patient_case, const HapticModel& model, const TouchTarget& start,
                           Vector3d way, double length, const std::optional<FirstEye>& eye) {
    constexpr double step = 1;  // mm
    std::vector<Vector3d> points;
    Vector3d at = start.place.point;
    for (double gone = step; gone <= length; gone += step) {
        const auto next = reached_in_sight(patient_case, model, start, at + step * way, eye);
        if (!next || (next->place.point - at).norm() < 0.5 * step) break;
        way = next->place.point - at;
        way = (way - next->place.normal * next->place.normal.dot(way)).normalized();
        at = next->place.point;
        points.push_back(at);
    }
    return points;
}

// The longest line through a place, of several directions.
std::vector<Vector3d> line_through(const Case& patient_case, const HapticModel& model,
                                   const TouchTarget& middle, double spread,
                                   const std::optional<FirstEye>& eye) {
    constexpr int directions = 6;
    std::vector<Vector3d> longest;
    for (int i = 0; i < directions; ++i) {
        const Eigen::AngleAxisd turn(std::numbers::pi * i / directions, middle.place.normal);
        const Vector3d way = turn * middle.place.tangent;
        std::vector<Vector3d> line = walk(patient_case, model, middle, -way, spread, eye);
        std::ranges::reverse(line);
        line.push_back(middle.place.point);
        const std::vector<Vector3d> other = walk(patient_case, model, middle, way, spread, eye);
        line.insert(line.end(), other.begin(), other.end());
        if (line.size() > longest.size()) longest = line;
    }
    return longest;
}

// As long as the recipe asks for, or the longest of some.
std::vector<Vector3d> line_in_sight(const ExerciseRecipe& recipe, const Case& patient_case,
                                    const HapticModel& model, const TouchTarget& start,
                                    const std::optional<FirstEye>& eye) {
    constexpr std::size_t most_tries = 30;
    std::vector<Vector3d> middles = places_around(patient_case, start, recipe.spread, recipe.seed);
    middles.insert(middles.begin(), start.place.point);
    middles.resize(std::min(middles.size(), most_tries));
    std::vector<Vector3d> longest;
    for (const Vector3d& place : middles) {
        const auto middle = reached_in_sight(patient_case, model, start, place, eye);
        if (!middle) continue;
        std::vector<Vector3d> line = line_through(patient_case, model, *middle, recipe.spread, eye);
        if (line.size() > longest.size()) longest = std::move(line);
        if (length_of(longest) >= recipe.spread) break;
    }
    return longest;
}

std::vector<Vector3d> draw_line(const ExerciseRecipe& recipe, const Case& patient_case,
                                const HapticModel& model, const TouchTarget& start, const FirstEye& eye) {
    constexpr double shortest = 10;  // mm
    std::vector<Vector3d> line = line_in_sight(recipe, patient_case, model, start, eye);
    if (length_of(line) >= shortest) return line;
    line = line_in_sight(recipe, patient_case, model, start, std::nullopt);
    if (length_of(line) < shortest)
        throw InvalidInput({recipe.written_at.empty() ? recipe.name : recipe.written_at,
                            "a line finds no room near the start", "",
                            "write 'places_mm', or start elsewhere"});
    return line;
}

// Between the points of a line others, on the surface that is nearest to them.
std::vector<Vector3d> along_surface(const std::vector<Vector3d>& points, const HapticModel& model) {
    constexpr double apart = 1, farthest = 20;  // mm
    std::vector<Vector3d> line{points.front()};
    for (std::size_t i = 1; i < points.size(); ++i) {
        const Vector3d way = points[i] - points[i - 1];
        const double pieces = std::ceil(way.norm() / apart - 1e-6);
        for (double piece = 1; piece < pieces; ++piece) {
            const Vector3d between = points[i - 1] + way * (piece / pieces);
            double reach = farthest;
            Vector3d nearest = between;
            for (std::size_t body = 0; body < model.body_count(); ++body)
                if (const auto found = model.surface(body).closest_point(between, reach)) {
                    reach = found->distance;
                    nearest = found->point;
                }
            line.push_back(nearest);
        }
        line.push_back(points[i]);
    }
    return line;
}

// From between the jaws' tips, half their length below the rim, out of it.
std::vector<Vector3d> draw_retraction(const HapticModel& model, const TouchTarget& start) {
    const Vector3d& out = start.place.normal;
    const Vector3d tips = start.place.point - session::grasp_depth(model.settings().shaft_length) * out;
    return {start.place.point, tips, tips + devices::GraspSettings{}.pull * out};
}

double tolerance_of(const ExerciseRecipe& recipe, const HapticModel& model) {
    if (recipe.tolerance) return *recipe.tolerance;
    if (recipe.task == Task::retract) return 2;
    return recipe.task == Task::find ? 10 : std::max(2.0, 1.5 * model.settings().tool_radius);
}

double two_digits(double value) {
    if (value <= 0) return value;
    const double unit = std::pow(10, std::floor(std::log10(value)) - 1);
    return std::round(value / unit) * unit;
}

}  // namespace

std::vector<HiddenRegion> hidden_regions(const Case& patient_case) {
    std::vector<HiddenRegion> regions;
    for (std::size_t i = 0; i < patient_case.deformable_bodies.size(); ++i) {
        const DeformableBody& soft = patient_case.deformable_bodies[i];
        for (const Label& label : enclosed_regions(soft.mesh))
            regions.push_back(hidden_region(patient_case, patient_case.rigid_bodies.size() + i, label));
    }
    std::ranges::sort(regions, {}, &HiddenRegion::name);
    return regions;
}

TouchTarget choose_start(const Case& patient_case, const HapticModel& model, const std::string& body_name,
                         std::uint64_t seed) {
    constexpr double nearest = 0.07, farthest = 0.16;  // of the body's extent
    const TouchTarget usual = session::choose_touch_target(patient_case, model, body_name, std::nullopt);
    const std::vector<HiddenRegion> regions = hidden_regions(patient_case);
    const auto region = std::ranges::find(regions, usual.body, &HiddenRegion::body);
    if (region == regions.end()) return usual;
    const auto above = reached_nearest(patient_case, model, *region);
    if (!above) return usual;
    Eigen::AlignedBox3d box;
    for (const Vector3d& vertex : session::surface_of(patient_case, region->body).vertices)
        box.extend(vertex);
    const double extent = box.diagonal().norm();
    for (const Vector3d& place : places_around(patient_case, *above, farthest * extent, seed)) {
        if ((place - region->above).norm() < nearest * extent) continue;
        const auto start = reached(patient_case, model, region->body, place, above->place.normal);
        if (start && is_clear_between(model, *start, *above)) return *start;
    }
    return *above;
}

std::optional<Exercise> lay_out_settled(const ExerciseRecipe& recipe, const Case& patient_case,
                                        const HapticModel& model) {
    Exercise exercise{.name = recipe.name,
                      .title = recipe.title,
                      .instruction = recipe.instruction,
                      .task = recipe.task,
                      .time_limit = recipe.time_limit.value_or(0),
                      .least_force = *recipe.least_force,
                      .most_force = *recipe.most_force,
                      .tolerance = tolerance_of(recipe, model),
                      .hold = recipe.hold.value_or(0.5),
                      .places = recipe.places,
                      .region = recipe.region};
    if (exercise.least_force >= exercise.most_force) exercise.least_force = exercise.most_force / 10;
    if (recipe.task == Task::trace && !recipe.places.empty())
        exercise.places = along_surface(recipe.places, model);
    if (recipe.task == Task::find) {
        const auto region = region_of(recipe, patient_case);
        if (!region) return std::nullopt;
        exercise.region = region->name;
        exercise.places = {region->above};
        exercise.outline =
            region_outline(soft_body(patient_case, region->body), region->label, region->above);
    }
    return exercise;
}

std::optional<Exercise> lay_out(const ExerciseRecipe& recipe, const Case& patient_case, HapticModel& model,
                                const TouchTarget& start, const FirstEye& eye) {
    ExerciseRecipe whole = recipe;
    const auto usual_force = [&](double depth) {
        return two_digits(
            std::min(force_at_depth(model, start.place, depth), 0.8 * model.settings().max_force));
    };
    if (whole.places.empty() && recipe.task == Task::retract) whole.places = draw_retraction(model, start);
    if (recipe.task == Task::retract) {
        if (!whole.least_force) whole.least_force = least_hold;
        if (!whole.most_force) whole.most_force = most_pull;
    }
    if (!whole.least_force) whole.least_force = usual_force(least_depth);
    if (!whole.most_force) whole.most_force = usual_force(most_depth);
    if (whole.places.empty() && recipe.task == Task::touch)
        whole.places = draw_marks(recipe, patient_case, model, start, 2 * tolerance_of(recipe, model), eye);
    if (whole.places.empty() && recipe.task == Task::trace)
        whole.places = draw_line(recipe, patient_case, model, start, eye);
    return lay_out_settled(whole, patient_case, model);
}

double force_at_depth(HapticModel& model, const devices::TouchPoint& place, double depth) {
    constexpr int ticks = 300, steady = 100;
    const double radius = model.settings().tool_radius;
    const double outside = radius + std::min(room, place.clearance), deepest = radius - depth;
    // Other tools are not there.
    std::vector<realtime::DeviceState> states(model.tool_count(), {.faults = device_lost});
    std::vector<TickResult> results(model.tool_count());
    realtime::DeviceState& state = states.front();
    state.faults = no_fault;
    model.reset();
    for (int i = 0; i < ticks; ++i) {
        const double way = std::min(1.0, static_cast<double>(i) / (ticks - steady));
        state.position = array_of(place.point + place.normal * (outside + (deepest - outside) * way));
        state.time = i * 0.001;
        model.tick(states, results);
    }
    model.reset();
    return vector_of(results.front().force).norm();
}

}  // namespace palpate::training
