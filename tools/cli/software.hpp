// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>

namespace palpate::cli {

/// What provenance says of the software: {"palpate": version, "libraries": {"CGAL": "5.5.1", ...}}, the
/// libraries that this build stands on.
nlohmann::ordered_json software_versions();

}  // namespace palpate::cli
