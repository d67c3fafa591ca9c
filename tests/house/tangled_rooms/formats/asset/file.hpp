// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/model/values.hpp"

namespace palpate::asset {
struct File;
}  // namespace palpate::asset
