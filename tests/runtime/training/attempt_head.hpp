// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/training/attempt_record.hpp"

namespace palpate::sample {

/// Of an attempt that ended then.
inline training::AttemptHead attempt_head(const std::string& when) {
    return {.trainee = "T-07",
            .began = "2026-03-01T09:29:00Z",
            .when = when,
            .case_name = "liver 3",
            .device = "simulated",
            .scheme = "continuous",
            .version = "1.0"};
}

}  // namespace palpate::sample
