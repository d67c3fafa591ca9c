// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <gtest/gtest.h>
#include <vector>

#include "formats/elasticity/discretisation.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tools/fem/solvers/ordering.hpp"

namespace palpate {
namespace {

using namespace fem;

constexpr Material liver_like{.youngs_modulus = 6e-3, .poissons_ratio = 0.45};

TEST(SurfaceLastOrdering, numbers_every_free_node_once_and_contact_nodes_last) {
    for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
        auto body = test::held_block({4, 4, 4}, {4, 5, 6}, liver_like);
        body.element_order = order;
        const elasticity::Discretisation d = elasticity::discretise(body);
        std::vector<std::int32_t> contact;
        std::ranges::set_difference(boundary_surface(body.mesh).nodes, body.fixed_nodes,
                                    std::back_inserter(contact));
        const auto position = surface_last_ordering(d, contact);
        ASSERT_EQ(position.size(), d.node_count);
        const std::size_t free = d.node_count - d.fixed_nodes.size();
        std::vector<int> uses(free, 0);
        for (std::size_t node = 0; node < d.node_count; ++node) {
            if (std::ranges::binary_search(d.fixed_nodes, static_cast<std::int32_t>(node)))
                EXPECT_EQ(position[node], -1);
            else
                ++uses.at(static_cast<std::size_t>(position[node]));
        }
        EXPECT_TRUE(std::ranges::all_of(uses, [](int count) { return count == 1; }));
        for (std::size_t k = 0; k < contact.size(); ++k)
            EXPECT_EQ(position[static_cast<std::size_t>(contact[k])],
                      static_cast<std::int32_t>(free - contact.size() + k));
    }
}

}  // namespace
}  // namespace palpate
