// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/finding.hpp"

#include <algorithm>

namespace palpate::doctor {

const char* name_of(Level level) {
    return level == Level::ok ? "ok" : level == Level::warning ? "warning" : "problem";
}

std::size_t count(const Findings& findings, Level level) {
    return static_cast<std::size_t>(std::ranges::count(findings, level, &Finding::level));
}

}  // namespace palpate::doctor
