// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <spdlog/spdlog.h>
#include <string>

#include "formats/records/status_counts.hpp"

namespace palpate::apps {

/// Ends a run: says in one line on stderr what of its ticks a user must know, or nothing.
inline void tell_statuses(const StatusCounts& statuses) {
    if (const std::string line = statuses.closing_line(); !line.empty()) spdlog::warn("{}", line);
}

}  // namespace palpate::apps
