// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <optional>

#include "tools/meshing/contract/contract.hpp"

namespace palpate::meshing {

/// Writes a check as numbers: name, measure, region (but for the body), value, bound, limit, unit, met,
/// at_mm.
nlohmann::ordered_json to_json(const ContractCheck& check);

/// Reads what to_json() wrote; nothing if it is something else.
std::optional<ContractCheck> contract_check_from(const nlohmann::ordered_json& json);

}  // namespace palpate::meshing
