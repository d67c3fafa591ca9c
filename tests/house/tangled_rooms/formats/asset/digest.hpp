// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate {
struct Digest;
}  // namespace palpate
