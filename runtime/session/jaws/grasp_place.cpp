// SPDX-License-Identifier: Apache-2.0
#include "runtime/session/jaws/grasp_place.hpp"

#include <algorithm>
#include <cmath>
#include <vector>

#include "formats/model/errors.hpp"
#include "runtime/devices/jaws/jaws.hpp"
#include "runtime/session/touch_target.hpp"

namespace palpate::session {
namespace {

using namespace collision;
using namespace haptics;
using Eigen::Vector3d;

constexpr double most_compact = 0.75;  // of the open jaws' gap, that tissue may fill

// The rim below a triangle, if it is one: tissue between two flanks a little below the surface that both give
// way.
std::optional<devices::Grasp> rim_below(const CollisionSurface& surface, const JawSettings& jaws,
                                        const std::vector<bool>& free, const TriangleCorners& t) {
    const double depth = grasp_depth(jaws.jaw_length);
    const double gap = 2 * jaws.jaw_length * std::sin(devices::open_angle(jaws) / 2);
    const Vector3d top = (t[0] + t[1] + t[2]) / 3;
    const Vector3d out = (t[1] - t[0]).cross(t[2] - t[0]).normalized();
    const Vector3d within = top - depth * out;
    const auto flank = surface.closest_point(within, 0.5 * gap);
    if (!flank || surface.is_outside(within, *flank)) return std::nullopt;
    Vector3d aside = flank->point - within;
    aside -= aside.dot(out) * out;
    if (!(aside.norm() > 0.5 * flank->distance)) return std::nullopt;  // its top is nearer
    aside.normalize();
    const auto one = surface.sweep_sphere(within + gap * aside, within, 0);
    const auto other = surface.sweep_sphere(within - gap * aside, within, 0);
    if (!one || !other || !free[one->triangle] || !free[other->triangle]) return std::nullopt;
    const double thickness = (one->point - other->point).norm();
    if (thickness > most_compact * gap) return std::nullopt;
    Eigen::Matrix3d R_PT;
    R_PT << aside, out.cross(aside), out;
    return devices::Grasp{(one->point + other->point) / 2, Eigen::Quaterniond(R_PT), thickness, depth};
}

// Whether the open jaws are clear of everything on their way in.
bool is_reached(const HapticModel& model, const JawSettings& jaws, const devices::Grasp& grasp) {
    const int spheres = static_cast<int>(std::ceil(jaws.jaw_length / jaws.jaw_radius));
    const int steps = static_cast<int>(std::ceil(2 * grasp.depth / jaws.jaw_radius));
    for (int step = 0; step <= steps; ++step) {
        const Vector3d meet = grasp.meet + (grasp.outside() - grasp.meet) * step / steps;
        for (const devices::JawPlace& jaw :
             devices::jaw_places(meet, grasp.orientation, jaws, devices::open_angle(jaws)))
            for (int sphere = 0; sphere <= spheres; ++sphere) {
                const Vector3d centre = jaw.tip + jaws.jaw_length * sphere / spheres * jaw.shaft;
                for (std::size_t body = 0; body < model.body_count(); ++body)
                    if (model.surface(body).closest_point(centre, jaws.jaw_radius) ||
                        !model.surface(body).is_outside(centre))
                        return false;
            }
    }
    return true;
}

}  // namespace

GraspPlace choose_grasp_place(const Case& patient_case, const HapticModel& model, const JawSettings& jaws,
                              const std::string& body_name, const std::optional<Vector3d>& near) {
    const std::size_t body = find_body(model, body_name);
    if (body_name.empty() && body < model.rigid_count())
        throw InvalidInput({patient_case.name, "has no body that gives way", "",
                            "a forceps takes hold of tissue: leave it out"});
    if (body < model.rigid_count())
        throw UsageError({"--body", "'" + model.body_name(body) + "' is rigid", "a body that gives way",
                          "a forceps takes hold of tissue"});
    const DeformableBody& soft = patient_case.deformable_bodies[body - model.rigid_count()];
    const TriangleMesh& mesh = surface_of(patient_case, body);
    struct Candidate {
        devices::Grasp grasp;
        double rank;  // least first
    };
    std::vector<Candidate> candidates;
    const std::vector<std::int32_t> triangles = free_triangles(patient_case, body);
    std::vector<bool> free(mesh.triangles.size(), false);
    for (const std::int32_t triangle : triangles) free[triangle] = true;
    for (const std::int32_t triangle : triangles) {
        const auto grasp =
            rim_below(model.surface(body), jaws, free, corners_of(mesh, mesh.triangles[triangle]));
        if (grasp) candidates.push_back({*grasp, near ? (grasp->meet - *near).norm() : grasp->thickness});
    }
    std::ranges::stable_sort(candidates, {}, &Candidate::rank);
    const auto is_held = [&](const devices::Grasp& grasp) {
        return std::ranges::any_of(soft.fixed_nodes, [&](std::int32_t node) {
            return (soft.mesh.rest_positions[node] - grasp.meet).norm() < grasp.depth;
        });
    };
    for (const auto& [grasp, rank] : candidates)
        if (!is_held(grasp) && is_reached(model, jaws, grasp)) return {body, grasp};
    throw InvalidInput({model.body_name(body),
                        "has no rim that fits between the open jaws and can be reached", "",
                        "give a longer --jaw-length or a wider --jaw-opening"});
}

}  // namespace palpate::session
