// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/readings/force_colour.hpp"

#include <algorithm>

namespace palpate::visual {

Rgb force_colour(double share) {
    const Rgb none(72, 132, 204), half(214, 160, 80), most(255, 236, 120);
    const auto s = static_cast<float>(2 * std::clamp(share, 0.0, 1.0));
    return s < 1 ? Rgb(none + s * (half - none)) : Rgb(half + (s - 1) * (most - half));
}

}  // namespace palpate::visual
