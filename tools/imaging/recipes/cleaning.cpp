// SPDX-License-Identifier: GPL-3.0-or-later
// The cleaning steps that recipes share, each with its parameter.
#include <algorithm>

#include "tools/imaging/recipes/job.hpp"

namespace palpate::imaging {
namespace {

using Kind = RecipeParameter::Kind;
using Range = RecipeParameter::Range;

struct CleaningStep {
    RecipeParameter parameter;
    Mask (*apply)(const Mask&, double amount);  // a number above 0, or a flag that is set
};

const std::vector<CleaningStep>& cleaning_steps() {
    static const std::vector<CleaningStep> all{
        {{"close_mm", Kind::number, "mm", "0", "fill gaps that a ball of this radius does not fit into",
          Range::not_negative},
         close},
        {{"open_mm", Kind::number, "mm", "0", "remove what a ball of this radius does not fit into",
          Range::not_negative},
         open},
        {{"fill_holes", Kind::flag, "", "no", "fill enclosed background"},
         [](const Mask& mask, double) { return fill_holes(mask); }},
        {{"min_component_ml", Kind::number, "ml", "0", "drop smaller pieces", Range::not_negative},
         [](const Mask& mask, double ml) { return drop_small(mask, ml * cubic_mm_per_ml); }},
        {{"keep_largest", Kind::flag, "", "no", "keep the largest piece only"},
         [](const Mask& mask, double) { return keep_largest(mask); }},
        {{"smooth_mm", Kind::number, "mm", "0", "round details below this size off, volume kept",
          Range::not_negative},
         smooth}};
    return all;
}

// Those not written first, then as written.
std::vector<CleaningStep> steps_in_order(const std::vector<std::string>& written) {
    std::vector<CleaningStep> steps;
    for (const CleaningStep& step : cleaning_steps())
        if (std::ranges::count(written, step.parameter.name) == 0) steps.push_back(step);
    for (const std::string& name : written)
        for (const CleaningStep& step : cleaning_steps())
            if (step.parameter.name == name) steps.push_back(step);
    return steps;
}

}  // namespace

RecipeParameters cleaning_parameters() {
    RecipeParameters parameters;
    for (const CleaningStep& step : cleaning_steps()) parameters.push_back(step.parameter);
    return parameters;
}

Mask cleaned(Mask mask, const Job& job) {
    const Parameters& p = job.parameters;
    mask = clip(mask, region_of(p));
    for (const auto& [parameter, apply] : steps_in_order(job.structure.order)) {
        if (!p.has(parameter.name)) continue;
        const double amount = parameter.kind == Kind::number ? p.number(parameter.name)
                              : p.flag(parameter.name)       ? 1
                                                             : 0;
        if (amount > 0) mask = apply(mask, amount);
    }
    return mask;
}

}  // namespace palpate::imaging
