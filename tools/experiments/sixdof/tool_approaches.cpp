// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/sixdof/tool_approaches.hpp"

#include <algorithm>
#include <thread>

#include "formats/model/arrays.hpp"
#include "runtime/devices/simulated_device.hpp"
#include "tools/experiments/sixdof/tool_judge.hpp"
#include "tools/experiments/sixdof/tool_visits.hpp"

namespace palpate::experiments {
namespace {

using namespace haptics;
using Eigen::Vector3d;

constexpr double stroke = 10, beyond_depth = 5;  // mm

struct Course {
    bool began_inside = false, beyond = false, through = false, met = false, unsolved = false;
};

Course approach(HapticModel& model, const FclJudge& judge, std::span<const Vector3d> core,
                const ToolVisit& visit) {
    model.reset();
    devices::SimulatedDevice hand(visit.path, {});
    const collision::CollisionSurface& bone = model.surface(0);
    const auto ticks = static_cast<std::int64_t>(1000 * visit.path.duration());
    TickResult result{};
    Course course;
    std::vector<Vector3d> was(core.size());
    for (std::int64_t tick = 0; tick <= ticks; ++tick) {
        model.tick(hand.read(1e-3 * static_cast<double>(tick)), result);
        course.began_inside |= (result.status & starts_inside) != 0;
        if (course.began_inside) return course;
        course.unsolved |= (result.status & contact_unsolved) != 0;
        const Eigen::Isometry3d X_PT = pose_in(result);
        if (!course.met) course.met = judge.meet(X_PT);
        for (std::size_t i = 0; i < core.size(); ++i) {
            const Vector3d at = X_PT * core[i];
            if (tick > 0 && !course.through) course.through = bone.sweep_sphere(was[i], at, 0).has_value();
            was[i] = at;
        }
    }
    course.beyond = visit.place.direction.dot(vector_of(result.tool_position) - visit.place.entry) +
                        model.contact_radius() >
                    beyond_depth;
    return course;
}

}  // namespace

ToolApproaches approach_with_tool(std::span<const std::unique_ptr<HapticModel>> models, const FclJudge& judge,
                                  std::span<const Vector3d> core, std::span<const Place> places,
                                  std::int64_t count, std::mt19937_64& random,
                                  const std::function<void(double)>& progress) {
    constexpr std::int64_t batch = 500;
    ToolApproaches all;
    std::vector<ToolVisit> visits;
    std::vector<Course> courses;
    while (all.count < count) {
        progress(static_cast<double>(all.count) / static_cast<double>(count));
        visits.clear();
        for (const std::int64_t end = std::min(all.count + batch, count); all.count < end; ++all.count)
            visits.push_back(fast_visit(places[static_cast<std::size_t>(all.count) % places.size()],
                                        models[0]->contact_radius(), stroke, random));
        courses.assign(visits.size(), {});
        {
            std::vector<std::jthread> threads;
            for (std::size_t worker = 0; worker < models.size(); ++worker)
                threads.emplace_back([&, worker] {
                    for (std::size_t i = worker; i < visits.size(); i += models.size())
                        courses[i] = approach(*models[worker], judge, core, visits[i]);
                });
        }
        for (const Course& course : courses) {
            all.began_inside += course.began_inside;
            if (course.began_inside) continue;
            all.beyond += course.beyond;
            all.through += course.through;
            all.met += course.met;
            all.unsolved += course.unsolved;
        }
    }
    return all;
}

}  // namespace palpate::experiments
