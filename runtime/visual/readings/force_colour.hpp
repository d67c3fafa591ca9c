// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/visual/actors.hpp"

namespace palpate::visual {

/// What a force looks like: blue for none, over orange, to pale yellow for the largest, lighter all the
/// way, so that eyes that do not tell colours apart tell it too. `share`: of the largest, 0 ... 1.
Rgb force_colour(double share);

}  // namespace palpate::visual
