// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "tools/cli/command.hpp"
#include "tools/tissue/tissue.hpp"

namespace {
using namespace palpate;
using Json = nlohmann::ordered_json;

Json row_of(const tissue::Tissue& tissue) {
    Json relaxation = Json::array();
    for (const RelaxationTerm& term : tissue.relaxation)
        relaxation.push_back({{"share", term.share}, {"time_s", term.time}});
    return {{"tissue", tissue.name},
            {"meaning", tissue.meaning},
            {"youngs_modulus_kpa", tissue.youngs_modulus_kpa},
            {"plausible_kpa", {tissue.least_kpa, tissue.most_kpa}},
            {"poissons_ratio", tissue.poissons_ratio},
            {"density_kg_m3", tissue.density_kg_m3},
            {"relaxation", relaxation},
            {"source", tissue.source}};
}

std::string lines_of(const tissue::Tissue& tissue) {
    return fmt::format(
        "{}: {}\n  E {:g} kPa ({:g} to {:g}), Poisson's ratio {:g}, {:g} kg/m³, relaxation {}\n  {}\n",
        tissue.name, tissue.meaning, tissue.youngs_modulus_kpa, tissue.least_kpa, tissue.most_kpa,
        tissue.poissons_ratio, tissue.density_kg_m3, relaxation_text(tissue.relaxation), tissue.source);
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "tissues",
         .summary = "Lists the tissues that a case file may name, with their values and sources.",
         .examples = {"palpate tissues", "palpate tissues liver --json -"},
         .notes = "A case file takes them by tissue = \"liver\" in [[deformable.region]]; what is written "
                  "beside it goes before."});
    std::string name;
    command.option("tissue", name, "one of them; all without it");
    return command.run(argc, argv, [&](cli::Session& session) {
        Json rows = Json::array();
        for (const tissue::Tissue& tissue : tissue::tissues()) {
            if (!name.empty() && &tissue != &tissue::require_tissue(name, "tissue")) continue;
            rows.push_back(row_of(tissue));
            session.text += lines_of(tissue);
        }
        return Json{{"tissues", rows}};
    });
}
