// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runtime/apps/options/tool_option.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {

/// What the user asked of touch.
struct TouchOptions {
    std::filesystem::path asset, log, curve, record, replay;
    std::string script = "press", body, target, second, scheme{haptics::usual_contact_method}, device, shaft,
                stream;
    std::vector<std::filesystem::path> trusted;
    double seconds = 10, depth = 3, speed = 20, record_seconds = 300;
    std::uint64_t seed = 1;
    std::optional<std::size_t> column;
    ToolOption tool;
    std::vector<std::string> hyperelastic;
    bool seconds_given = false, virtual_clock = false;
};

/// Those of which it counts whether they were given.
struct TouchHandles {
    cli::Option asset, script, seconds, log, curve, replay;
};

/// Adds the options of touch to its command, set to what `options` holds.
TouchHandles declare(cli::Command& command, TouchOptions& options);

}  // namespace palpate::apps
