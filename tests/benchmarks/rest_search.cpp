// SPDX-License-Identifier: GPL-3.0-or-later
// rest_search ASSET ...: what the search for the rest of neo-Hookean tissue takes of the period that its loop
// has: the factor, and two warm steps while a press grows (median).
#include <algorithm>
#include <chrono>
#include <exception>
#include <fmt/format.h>
#include <vector>

#include "formats/asset/asset.hpp"
#include "formats/hyperelasticity/equilibrium.hpp"
#include "runtime/haptics/collision_loop.hpp"

namespace {

constexpr int answers = 100;
constexpr double largest_force = 0.5;  // N, on one node

template <typename Work>
double milliseconds_of(const Work& work) {
    const auto begin = std::chrono::steady_clock::now();
    work();
    return std::chrono::duration<double, std::milli>(std::chrono::steady_clock::now() - begin).count();
}

}  // namespace

int main(int count, char** arguments) {
    using namespace palpate;
    if (count < 2) return 2;
    try {
        fmt::print(
            "| case: body | nodes | factor, s | two steps, ms | of the period |\n|---|--:|--:|--:|--:|\n");
        for (int argument = 1; argument < count; ++argument)
            for (const Case patient_case = asset::load_asset(arguments[argument]);
                 const DeformableBody& body : patient_case.deformable_bodies) {
                std::unique_ptr<hyperelasticity::Equilibrium> equilibrium;
                const double factor = milliseconds_of(
                    [&] { equilibrium = std::make_unique<hyperelasticity::Equilibrium>(body); });
                const auto node = static_cast<std::size_t>(body.contact_nodes[body.contact_nodes.size() / 2]);
                Eigen::VectorXd loads = Eigen::VectorXd::Zero(equilibrium->mesh().dofs());
                std::vector<double> times;
                for (int answer = 1; answer <= answers; ++answer) {
                    loads.segment<3>(3 * equilibrium->mesh().positions()[node]).x() =
                        largest_force * answer / answers;
                    times.push_back(milliseconds_of([&] { equilibrium->approach(loads, 0, 2); }));
                }
                std::ranges::sort(times);
                const double period = 1e-6 * haptics::CollisionLoop::force_period_ns;
                fmt::print("| {}: {} | {} | {:.2f} | {:.1f} | {:.2f} |\n", patient_case.name, body.name,
                           body.mesh.rest_positions.size(), 1e-3 * factor, times[answers / 2],
                           times[answers / 2] / period);
            }
    } catch (const std::exception& error) {
        fmt::print(stderr, "rest_search: {}\n", error.what());
        return 1;
    }
}
