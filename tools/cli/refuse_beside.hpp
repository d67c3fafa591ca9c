// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <nlohmann/json.hpp>
#include <span>
#include <string>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"

namespace palpate::cli {

/// Whether the user gave an option another value than its default, which 3D Slicer passes unasked.
inline bool asked_for(const Parameter& parameter) {
    return parameter.option.given() && parameter.value().dump() != parameter.unset;
}

/// Throws UsageError if the user asked for any option but `allowed` beside `option`, saying `why`.
inline void refuse_beside(const Command& command, const std::string& option, std::span<const Option> allowed,
                          const std::string& why) {
    std::string names;
    for (const Option& other : allowed)
        if (other.name().starts_with("--") && other.name() != option)
            names += (names.empty() ? "" : ", ") + other.name();
    for (const Parameter& parameter : command.parameters())
        if (asked_for(parameter) && std::ranges::find(allowed, parameter.option) == allowed.end())
            throw UsageError({parameter.option.name(), "with " + option, names + " at most", why});
}

}  // namespace palpate::cli
