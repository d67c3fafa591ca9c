// SPDX-License-Identifier: GPL-3.0-or-later
// judged_draws ASSET [DRAWS]: how far the bodies' sound compliances are off the mesh that touch judges them
// by, over so many draws of the loads (1000).
#include <algorithm>
#include <cstdint>
#include <exception>
#include <fmt/format.h>
#include <string>
#include <vector>

#include "formats/asset/asset.hpp"
#include "formats/elasticity/plausible_compliance.hpp"

int main(int count, char** arguments) {
    using namespace palpate;
    if (count < 2) return 2;
    try {
        const std::uint64_t draws = count > 2 ? std::stoul(arguments[2]) : 1000;
        for (const Case patient_case = asset::load_asset(arguments[1]);
             const DeformableBody& body : patient_case.deformable_bodies) {
            std::vector<double> parts;
            for (std::uint64_t seed = 0; seed < draws; ++seed) {
                const auto worst = elasticity::worst_answer(body, seed);
                parts.push_back(worst ? worst->part() : elasticity::most_off + 1);
            }
            std::ranges::sort(parts);
            const auto refused = parts.end() - std::ranges::upper_bound(parts, elasticity::most_off);
            fmt::print(
                "{}: worst node off by {:.2g} (median), {:.2g} (nine of ten), {:.2g} (most); {} of {} "
                "refused\n",
                body.name, parts[parts.size() / 2], parts[parts.size() * 9 / 10], parts.back(), refused,
                parts.size());
        }
    } catch (const std::exception& error) {
        fmt::print(stderr, "judged_draws: {}\n", error.what());
        return 1;
    }
}
