// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/asset/file.hpp"

namespace palpate::model {
struct Values;
}  // namespace palpate::model
