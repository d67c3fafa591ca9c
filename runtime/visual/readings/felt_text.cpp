// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/readings/felt_text.hpp"

#include <algorithm>
#include <cmath>

#include "runtime/texts/translated.hpp"

namespace palpate::visual {

using texts::translated;

std::string felt_text(const DeformableBody& body, std::int32_t region, std::optional<double> rendered) {
    if (!body.feel) return "";
    const auto felt = std::ranges::find(body.feel->regions, region, &FeltRegion::region);
    if (felt == body.feel->regions.end()) return "";
    const double percent = 100 * contrast_of(*felt);
    const std::string contrast =
        percent < 0 ? translated("softer by {:.0f} %", -percent) : translated("stiffer by {:.0f} %", percent);
    switch (verdict_of(*felt, body.feel->depth, rendered.value_or(rendered_force))) {
        case FeltVerdict::too_faint:
            return translated("{}, too faint to feel", contrast);
        case FeltVerdict::too_varied:
            return translated("{}, no more than tissue varies by around it", contrast);
        case FeltVerdict::too_weak:
            return rendered ? translated("{}, too weak for this device", contrast)
                            : translated("{}, too weak for many devices", contrast);
        case FeltVerdict::felt:
            break;
    }
    return translated("{}, can be felt", contrast);
}

}  // namespace palpate::visual
