// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::realtime {

/// Seconds since the operating system started this process, to 10 ms.
double process_age();

}  // namespace palpate::realtime
