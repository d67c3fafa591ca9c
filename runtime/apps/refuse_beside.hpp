// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <span>
#include <string>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {

/// Throws UsageError if the user gave any option but `allowed` beside `option`, which names a recording, for
/// a recording says itself what the run was like.
inline void refuse_beside(const cli::Command& command, const std::string& option,
                          std::span<const cli::Option> allowed) {
    std::string names;
    for (const cli::Option& other : allowed)
        if (other.name().starts_with("--") && other.name() != option)
            names += (names.empty() ? "" : ", ") + other.name();
    for (const cli::Parameter& parameter : command.parameters())
        if (parameter.option.given() && std::ranges::find(allowed, parameter.option) == allowed.end())
            throw UsageError({parameter.option.name(), "with " + option, names + " at most",
                              "a recording says itself what the run was like"});
}

}  // namespace palpate::apps
