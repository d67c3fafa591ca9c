// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <optional>
#include <string>

#include "formats/model/body.hpp"

namespace palpate::visual {

/// What a hand feels of a region of a body, in the user's language: "stiffer by 34 %, can be felt"; empty
/// where nobody has computed it. `region`: its label value; `rendered`: the least difference of force that
/// the device renders, N; nothing of a device of which that is not known, where rendered_force counts.
std::string felt_text(const DeformableBody& body, std::int32_t region, std::optional<double> rendered);

}  // namespace palpate::visual
