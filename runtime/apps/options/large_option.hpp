// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

#include "tools/cli/command.hpp"

namespace palpate::apps {

/// Adds --large-deformation to a command: the deformable bodies whose tissue is neo-Hookean, or "all".
void declare_large_deformation(cli::Command& command, std::vector<std::string>& bodies);

/// Throws UsageError if bodies are asked for and `scheme` does not know neo-Hookean tissue.
void check_large_deformation(const std::vector<std::string>& bodies, const std::string& scheme);

}  // namespace palpate::apps
