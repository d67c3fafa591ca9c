// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <vector>

namespace palpate::provenance {

/// What a case's provenance (JSON) says that a certificate does not: what was made up, where values come
/// from, which bodies end at the image's edge, what of the image is in doubt. A sentence each; none where it
/// is silent or no JSON.
std::vector<std::string> cautions_in(const std::string& provenance);

}  // namespace palpate::provenance
