// SPDX-License-Identifier: Apache-2.0
#include "formats/records/material.hpp"

#include <array>
#include <cstdio>
#include <string>

namespace palpate {

std::optional<FieldError> relaxation_error(std::span<const RelaxationTerm> terms) {
    if (terms.size() > most_relaxation_terms)
        return FieldError{"relaxation", "has " + std::to_string(terms.size()) + " terms",
                          std::to_string(most_relaxation_terms) + " at most"};
    double sum = 0, last = 0;
    for (const RelaxationTerm& term : terms) {
        if (auto error = first_error(relaxation_fields, term)) return error;
        if (!(term.time > last))
            return FieldError{"time", "is " + std::to_string(term.time) + " s after " + std::to_string(last),
                              "ascending times, each once"};
        last = term.time;
        sum += term.share;
    }
    constexpr double rounding = 1e-12;  // of a sum
    if (sum <= most_relaxation + rounding) return std::nullopt;
    std::array<char, 32> most{};
    std::snprintf(most.data(), most.size(), "%g at most", most_relaxation);
    return FieldError{"share", "is " + std::to_string(sum) + " in all terms together", most.data()};
}

std::string relaxation_text(std::span<const RelaxationTerm> terms) {
    std::string text;
    for (const RelaxationTerm& term : terms) {
        std::array<char, 64> part{};
        std::snprintf(part.data(), part.size(), "%g %% in %g s", 100 * term.share, term.time);
        text += (text.empty() ? "" : ", ") + std::string(part.data());
    }
    return text.empty() ? "none" : text;
}

}  // namespace palpate
