// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <nlohmann/json_fwd.hpp>
#include <span>
#include <string>

#include "runtime/apps/touch_outputs.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {

/// Replays a recording of a run on `asset` and holds its forces against the recorded ones; sets
/// session.shortfall if they differ. With keys, one of them must have signed the asset. Throws InvalidInput
/// if it is of another asset, damaged or too short.
nlohmann::ordered_json replay_recording(const std::filesystem::path& file, const std::filesystem::path& asset,
                                        std::span<const std::string> trusted_keys, TouchOutputs& outputs,
                                        cli::Session& session);

}  // namespace palpate::apps
