// SPDX-License-Identifier: GPL-3.0-or-later
// judge_by_calculix ASSET RECORDING TICK ...: what a recorded run of tools on neo-Hookean tissue made of it
// in those ticks, beside what CalculiX does under the same forces on the same mesh. A row for each tick and
// deformable body that is pressed: tick, sum of the forces (N), largest displacement (mm), how far the
// surface is turned (degrees); by how much the run and then linear tissue are off, in per cent: along the
// forces, and the surface; and the body's name.
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>
#include <exception>
#include <fmt/format.h>
#include <numbers>
#include <set>
#include <string>
#include <vector>

#include "formats/recording/recording.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/session/drawn_shape.hpp"
#include "runtime/session/replay.hpp"
#include "tests/tools/fem/certificate/calculix.hpp"

namespace palpate {
namespace {

using Eigen::Index;
using Eigen::Vector3f;
using Fields = std::vector<Vector3f>;  // by surface vertex

// By surface vertex, N, as they are spread over the surface.
Fields loads_of(const haptics::DeformableContact& contact, const std::vector<TickResult>& tools) {
    std::vector<haptics::SurfaceForce> forces;
    for (const TickResult& tool : tools)
        contact.append_forces(std::span(tool.contacts).first(static_cast<std::size_t>(tool.contact_count)),
                              forces);
    Fields loads(contact.vertex_count(), Vector3f::Zero());
    contact.each_load(forces, [&](std::int32_t vertex, const Vector3f& force) {
        loads[static_cast<std::size_t>(vertex)] += force;
    });
    return loads;
}

// Of a vector of three entries a node.
Fields at_surface(const DeformableBody& body, const Eigen::VectorXd& of_nodes) {
    Fields field;
    for (const std::int32_t node : body.boundary.nodes)
        field.emplace_back(of_nodes.segment<3>(3 * Index{node}).cast<float>());
    return field;
}

double work_of(const Fields& loads, const Fields& moved) {
    double work = 0;
    for (std::size_t v = 0; v < loads.size(); ++v) work += static_cast<double>(loads[v].dot(moved[v]));
    return work;
}

double largest_of(const Fields& moved) {
    float largest = 0;
    for (const Vector3f& way : moved) largest = std::max(largest, way.norm());
    return static_cast<double>(largest);
}

double apart(const Fields& a, const Fields& b) {
    float most = 0;
    for (std::size_t v = 0; v < a.size(); ++v) most = std::max(most, (a[v] - b[v]).norm());
    return static_cast<double>(most);
}

// How far the surface is turned, degrees: nine of ten of its triangles by less.
double turn_of(const TriangleMesh& surface, const Fields& moved) {
    std::vector<double> turns;
    for (const Triangle& triangle : surface.triangles) {
        const auto normal = [&](const Fields* by) {
            std::array<Eigen::Vector3d, 3> at;
            for (std::size_t i = 0; i < 3; ++i) {
                const auto v = static_cast<std::size_t>(triangle[i]);
                at[i] = surface.vertices[v];
                if (by) at[i] += (*by)[v].cast<double>();
            }
            return (at[1] - at[0]).cross(at[2] - at[0]).normalized();
        };
        turns.push_back(std::acos(std::clamp(normal(nullptr).dot(normal(&moved)), -1.0, 1.0)));
    }
    std::ranges::sort(turns);
    return turns[turns.size() * 9 / 10] * 180 / std::numbers::pi;
}

void judge(const Case& patient_case, const haptics::ContactBodies& contacts,
           const haptics::HapticModel& model, session::DrawnShape& drawn_shape,
           const std::vector<TickResult>& tools) {
    std::vector<const TickResult*> ticks;
    for (const TickResult& tool : tools) ticks.push_back(&tool);
    std::vector<Fields> drawn;
    for (const DeformableBody& body : patient_case.deformable_bodies)
        drawn.emplace_back(body.boundary.nodes.size(), Vector3f::Zero());
    drawn_shape.follow(model, 1e-3 * static_cast<double>(tools[0].tick), ticks, drawn);
    for (std::size_t soft = 0; soft < drawn.size(); ++soft) {
        const DeformableBody& body = patient_case.deformable_bodies[soft];
        const Fields loads = loads_of(contacts.deformable[soft], tools);
        Vector3f sum = Vector3f::Zero();
        for (const Vector3f& load : loads) sum += load;
        if (largest_of(loads) == 0) continue;
        Eigen::VectorXd of_nodes =
            Eigen::VectorXd::Zero(3 * static_cast<Index>(body.mesh.rest_positions.size()));
        for (std::size_t v = 0; v < loads.size(); ++v)
            of_nodes.segment<3>(3 * Index{body.boundary.nodes[v]}) += loads[v].cast<double>();
        const Fields judged = at_surface(body, test::ask_calculix_neo_hookean(body, of_nodes));
        Fields linear(judged.size(), Vector3f::Zero()), of_one = linear;
        for (const TickResult& tool : tools) {
            model.surface_displacement(model.rigid_count() + soft, tool, of_one);
            for (std::size_t v = 0; v < linear.size(); ++v) linear[v] += of_one[v];
        }
        const double work = work_of(loads, judged), way = largest_of(judged);
        fmt::print("{} {:.4g} {:.2f} {:.0f} {:.2f} {:.2f} {:.2f} {:.2f} {}\n", tools[0].tick,
                   static_cast<double>(sum.norm()), way, turn_of(body.boundary.surface, judged),
                   100 * std::abs(work_of(loads, drawn[soft]) / work - 1),
                   100 * apart(drawn[soft], judged) / way, 100 * std::abs(work_of(loads, linear) / work - 1),
                   100 * apart(linear, judged) / way, body.name);
    }
}

void run(const std::string& asset, const std::string& file, const std::set<std::int64_t>& wanted) {
    const recording::Recording recording = recording::read_recording(file);
    const Case patient_case = session::recorded_case(recording, file, asset);
    const haptics::ContactBodies contacts(patient_case, true);
    const auto model = session::model_of(recording, file, patient_case);
    session::DrawnShape drawn_shape(patient_case);
    std::vector<TickResult> tools;
    session::replay(recording, *model, [&](const TickResult& result) {
        if (!wanted.contains(result.tick)) return;
        tools.push_back(result);
        if (tools.size() < model->tool_count()) return;
        judge(patient_case, contacts, *model, drawn_shape, tools);
        tools.clear();
    });
}

}  // namespace
}  // namespace palpate

int main(int count, char** arguments) {
    if (count < 4) return 2;
    try {
        std::set<std::int64_t> wanted;
        for (int argument = 3; argument < count; ++argument) wanted.insert(std::stol(arguments[argument]));
        palpate::run(arguments[1], arguments[2], wanted);
    } catch (const std::exception& error) {
        fmt::print(stderr, "judge_by_calculix: {}\n", error.what());
        return 1;
    }
}
