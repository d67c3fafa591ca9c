// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "tools/fem/assembly/node_rules.hpp"
#include "tools/fem/condensation/condensation_plan.hpp"

namespace palpate::condensation {

// All throw UsageError naming the option if the text is malformed.

/// "linear" or "quadratic".
ElementOrder parse_element_order(const std::string& text);
std::string name_of(ElementOrder order);

/// "auto", "dense" or "hierarchical".
Representation parse_representation(const std::string& text);

/// "liver:6.3,0.45", one for each region: its name, Young's modulus in kPa, Poisson's ratio. Returned
/// ascending by region. Throws InvalidInput naming `mesh_file` and the nearest names for a region that the
/// mesh does not have.
std::vector<RegionMaterial> parse_materials(const std::vector<std::string>& texts, const TetMesh& mesh,
                                            const std::string& mesh_file);

/// The rules given with `option`, "--fixed" or "--contact".
std::vector<NodeRule> parse_node_rules(const std::string& option, const std::vector<std::string>& texts);

}  // namespace palpate::condensation
