// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <fmt/format.h>
#include <nlohmann/json.hpp>
#include <spdlog/spdlog.h>

#include "formats/asset/parts.hpp"
#include "tools/cli/command.hpp"
#include "tools/fem/assembly/node_rules.hpp"
#include "tools/fem/solvers/dense_kernels.hpp"
#include "tools/stages/body.hpp"
#include "tools/stages/body_result.hpp"

namespace {
using namespace palpate;
using namespace palpate::fem;

void say_plan(const CondensationPlan& plan) {
    constexpr double mebibyte = 0x1p20;
    for (const CondensationForecast& forecast : plan.considered)
        spdlog::info("{}: about {:.0f} s, {:.0f} MiB of memory, {:.1f} MiB stored", name_of(forecast.method),
                     std::ceil(forecast.seconds), forecast.memory_bytes / mebibyte,
                     forecast.size_bytes / mebibyte);
    spdlog::info("chosen: {} ({})", name_of(plan.chosen.method), plan.reason);
}

// Linear elasticity is meant for small strains.
constexpr double much_stretch = 0.2;

void say_sag(const Sag& sag) {
    spdlog::info("gravity moves the body by up to {:.1f} mm and stretches edges by up to {:.0f} %",
                 sag.largest_displacement, 100 * sag.largest_stretch);
    if (sag.largest_stretch > much_stretch)
        spdlog::warn("that is more than linear tissue is good for: look at the shape in the report");
}

}  // namespace

int main(int argc, char** argv) {
    restart_with_fitting_kernels(argv);
    cli::Command command(
        {.name = "condense",
         .summary = "Computes the surface compliance C = (K^-1)_ss of a tetrahedral body, exact or "
                    "compressed, with its certificate.",
         .examples = {"palpate condense liver.vtu --material liver:6.3,0.45 --material tumour:30,0.45 "
                      "--fixed sphere:-14,30,20,30 -o liver.body.h5",
                      "palpate condense wall.vtu --material wall:7.8,0.49 --element quadratic "
                      "--fixed touching:skull --contact touching:airway -o wall.body.h5"},
         .notes = fmt::format(
             "Rules that pick nodes: {}.\n--fixed and --contact take the same rules, and several add up. "
             "Rules pick surface nodes; nodes:FILE may hold interior ones too. Only the nodes of the contact "
             "surface enter C, whose size grows with the square of their number; surface that is neither "
             "fixed "
             "nor contact surface deforms with the body here, but feels rigid when it is touched.\n"
             "Linear tetrahedra are too stiff where Poisson's ratio nears 0.5; quadratic ones are not, and "
             "have some eight times the unknowns.",
             node_rule_grammar)});
    stages::CondenseRequest request;
    declare(command, request);
    return command.run(argc, argv, [&](cli::Session& session) {
        cli::StagedFile staged = session.stage(request.output);
        set_linear_algebra_threads(session.threads);
        const stages::MadeBody made = make_body(
            request, session.threads,
            [&](std::string_view what, double done) { session.progress.step(what, done); },
            [&](const CondensationPlan& plan) {
                session.progress.finish();
                if (!session.quiet) say_plan(plan);
            });
        asset::write_body_part(staged.path(), made.body);
        staged.commit();
        if (made.sag && !session.quiet) say_sag(*made.sag);
        return stages::to_json(made);
    });
}
