// SPDX-License-Identifier: Apache-2.0
// The rows of bodies beside each other among those of tools; part of the tick.
#include "runtime/haptics/contact/equilibrium/contact_equilibrium.hpp"

namespace palpate::haptics {

using Eigen::Index;

// They come last. Returns how many rows are warm with them.
std::size_t ContactEquilibrium::add_neighbours(std::array<std::size_t, max_contacts>& warm,
                                               std::size_t warm_count) noexcept {
    const std::size_t tools = rows_.size();
    const auto put = [&](std::size_t k, std::size_t l, double value) {
        const auto row = static_cast<Index>(k), column = static_cast<Index>(l);
        lcp_.matrix()(row, column) = lcp_.matrix()(column, row) = value;
    };
    for (std::size_t k = 0; k < neighbours_.row_count(); ++k) {
        lcp_.gaps()[static_cast<Index>(tools + k)] = neighbours_.gap(k);
        for (std::size_t l = 0; l < tools; ++l) {
            const Row& row = rows_[l];
            put(tools + k, l,
                row.patch < 0 ? 0
                              : neighbours_.compliance_to_tool(patches_, k, row.patch, row.slots, row.weights,
                                                               row.normal));
        }
        for (std::size_t l = 0; l <= k; ++l) put(tools + k, tools + l, neighbours_.compliance(k, l));
        if (neighbours_.is_active(k)) warm[warm_count++] = tools + k;
    }
    return warm_count;
}

void ContactEquilibrium::take_neighbours() noexcept {
    const std::size_t tools = rows_.size(), count = neighbours_.row_count();
    neighbours_.take({lcp_.forces().data() + tools, count});
}

}  // namespace palpate::haptics
