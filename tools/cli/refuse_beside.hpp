// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <span>
#include <string>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"

namespace palpate::cli {

/// Throws UsageError if the user gave any option but `allowed` beside `option`, saying `why`.
inline void refuse_beside(const Command& command, const std::string& option, std::span<const Option> allowed,
                          const std::string& why) {
    std::string names;
    for (const Option& other : allowed)
        if (other.name().starts_with("--") && other.name() != option)
            names += (names.empty() ? "" : ", ") + other.name();
    for (const Parameter& parameter : command.parameters())
        if (parameter.option.given() && std::ranges::find(allowed, parameter.option) == allowed.end())
            throw UsageError({parameter.option.name(), "with " + option, names + " at most", why});
}

}  // namespace palpate::cli
