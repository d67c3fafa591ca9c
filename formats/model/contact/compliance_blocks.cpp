// SPDX-License-Identifier: Apache-2.0
#include "formats/model/contact/compliance_blocks.hpp"

#include <algorithm>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate {

std::vector<std::int32_t> compliance_blocks(const DeformableBody& body) {
    const std::int32_t nodes = node_count(body.compliance);
    if (static_cast<std::size_t>(nodes) != body.contact_nodes.size())
        throw InvalidInput({.culprit = body.name,
                            .found = "its compliance has " + std::to_string(nodes) + " nodes",
                            .expected = std::to_string(body.contact_nodes.size()),
                            .next_step = "condense it again with 'palpate condense'"});
    std::vector<std::int32_t> blocks;
    for (const std::int32_t node : body.boundary.nodes) {
        const auto found = std::ranges::lower_bound(body.contact_nodes, node);
        const bool free = found != body.contact_nodes.end() && *found == node;
        blocks.push_back(free ? static_cast<std::int32_t>(found - body.contact_nodes.begin()) : -1);
    }
    return blocks;
}

}  // namespace palpate
