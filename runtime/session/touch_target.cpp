// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/touch_target.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <functional>
#include <limits>
#include <vector>

#include "formats/model/errors.hpp"
#include "formats/model/label_map.hpp"
#include "runtime/haptics/contact/god_object.hpp"

namespace palpate::session {
namespace {

using namespace collision;
using namespace haptics;
using Eigen::Vector3d;

constexpr double full_clearance = 5;  // mm

// How far the tool can back out of `place` along its normal, at most full_clearance; nothing if it does not
// even fit there.
std::optional<double> clearance_at(const HapticModel& model, const Vector3d& point, const Vector3d& normal) {
    const double radius = model.settings().tool_radius;
    const Vector3d touching = point + (radius + 2 * GodObject::skin) * normal;
    const Vector3d outside = touching + full_clearance * normal;
    double clearance = full_clearance;
    for (std::size_t body = 0; body < model.body_count(); ++body) {
        const CollisionSurface& surface = model.surface(body);
        if (surface.closest_point(touching, radius) || !surface.is_outside(touching)) return std::nullopt;
        if (const auto contact = surface.sweep_sphere(touching, outside, radius))
            clearance = std::min(clearance, contact->fraction * full_clearance);
    }
    return clearance;
}

// What "far from the held part" is measured from: the fixed nodes, or a rigid surface's centroid.
std::vector<Vector3d> held_points(const Case& patient_case, const HapticModel& model, std::size_t body) {
    std::vector<Vector3d> points;
    if (body >= model.rigid_count()) {
        const DeformableBody& soft = patient_case.deformable_bodies[body - model.rigid_count()];
        for (const std::int32_t node : soft.fixed_nodes) points.push_back(soft.mesh.rest_positions[node]);
    } else {
        const TriangleMesh& surface = patient_case.rigid_bodies[body].surface;
        Vector3d sum = Vector3d::Zero();
        for (const Vector3d& vertex : surface.vertices) sum += vertex;
        points.push_back(sum / static_cast<double>(surface.vertices.size()));
    }
    return points;
}

TouchTarget target_on(std::size_t body, std::int32_t triangle, const TriangleCorners& t,
                      const Vector3d& point) {
    TouchTarget target;
    target.body = body;
    target.triangle = triangle;
    target.place.point = point;
    target.place.normal = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    target.place.tangent = target.place.normal.unitOrthogonal();
    target.place.clearance = 0;
    return target;
}

}  // namespace

std::size_t find_body(const HapticModel& model, const std::string& name) {
    const bool feels_tissue = model.method().can.feels_tissue;
    if (name.empty())
        return feels_tissue && model.rigid_count() < model.body_count() ? model.rigid_count() : 0;
    std::vector<std::string> names;
    for (std::size_t body = 0; body < model.body_count(); ++body) {
        names.push_back(model.body_name(body));
        if (names.back() != name) continue;
        if (body < model.rigid_count() || feels_tissue) return body;
        throw UsageError({"--body", "'" + name + "' is not rigid", "a rigid body",
                          "contact method '" + std::string(model.method().name) + "' feels no other"});
    }
    std::string near;
    for (const std::string& candidate : nearest_names(name, names))
        near += (near.empty() ? "'" : ", '") + candidate + "'";
    throw UsageError({"--body", "no body '" + name + "'", "", "nearest names: " + near});
}

const TriangleMesh& surface_of(const Case& patient_case, std::size_t body) {
    const std::size_t rigid = patient_case.rigid_bodies.size();
    return body < rigid ? patient_case.rigid_bodies[body].surface
                        : patient_case.deformable_bodies[body - rigid].boundary.surface;
}

std::vector<std::int32_t> free_triangles(const Case& patient_case, std::size_t body) {
    const TriangleMesh& mesh = surface_of(patient_case, body);
    const std::size_t rigid = patient_case.rigid_bodies.size();
    std::vector<bool> fixed(mesh.vertices.size(), false);
    if (body >= rigid) {
        const DeformableBody& soft = patient_case.deformable_bodies[body - rigid];
        for (std::size_t v = 0; v < fixed.size(); ++v)
            fixed[v] = std::ranges::binary_search(soft.fixed_nodes, soft.boundary.nodes[v]);
    }
    std::vector<std::int32_t> triangles;
    for (std::size_t t = 0; t < mesh.triangles.size(); ++t)
        if (std::ranges::none_of(mesh.triangles[t], [&](std::int32_t v) { return fixed[v]; }))
            triangles.push_back(static_cast<std::int32_t>(t));
    return triangles;
}

std::optional<TouchTarget> touch_target_near(const Case& patient_case, const HapticModel& model,
                                             std::size_t body, const Vector3d& place) {
    const auto nearest = model.surface(body).closest_point(place, std::numeric_limits<double>::max());
    const TriangleMesh& mesh = surface_of(patient_case, body);
    TouchTarget target = target_on(body, nearest->triangle,
                                   corners_of(mesh, mesh.triangles[nearest->triangle]), nearest->point);
    const auto clearance = clearance_at(model, target.place.point, target.place.normal);
    if (!clearance) return std::nullopt;
    target.place.clearance = *clearance;
    return target;
}

TouchTarget choose_touch_target(const Case& patient_case, const HapticModel& model,
                                const std::string& body_name, const std::optional<Vector3d>& near) {
    const std::size_t body = find_body(model, body_name);
    const TriangleMesh& mesh = surface_of(patient_case, body);
    const auto refuse = [&](const std::string& found, const std::string& next_step) {
        throw InvalidInput({model.body_name(body), found, "", next_step});
    };
    if (near) {
        const auto target = touch_target_near(patient_case, model, body, *near);
        if (!target) refuse("the tool does not fit at the point nearest to --target", "name another one");
        return *target;
    }

    const std::vector<Vector3d> held = held_points(patient_case, model, body);
    struct Candidate {
        TouchTarget target;
        double squared_distance;
    };
    std::vector<Candidate> candidates;
    for (const std::int32_t triangle : free_triangles(patient_case, body)) {
        const TriangleCorners t = corners_of(mesh, mesh.triangles[triangle]);
        Candidate candidate{target_on(body, triangle, t, (t[0] + t[1] + t[2]) / 3),
                            std::numeric_limits<double>::max()};
        for (const Vector3d& point : held)
            candidate.squared_distance =
                std::min(candidate.squared_distance, (candidate.target.place.point - point).squaredNorm());
        candidates.push_back(candidate);
    }
    std::ranges::stable_sort(candidates, std::greater<>{}, &Candidate::squared_distance);
    // The farthest with full clearance; failing that, the farthest of those with the most there is.
    std::optional<TouchTarget> best;
    for (Candidate& candidate : candidates) {
        const auto clearance =
            clearance_at(model, candidate.target.place.point, candidate.target.place.normal);
        if (!clearance || (best && *clearance <= best->place.clearance)) continue;
        candidate.target.place.clearance = *clearance;
        best = candidate.target;
        if (*clearance >= full_clearance) break;
    }
    if (!best)
        refuse("the tool reaches none of its free triangles", "use a smaller tool_radius or name a --target");
    return *best;
}

}  // namespace palpate::session
