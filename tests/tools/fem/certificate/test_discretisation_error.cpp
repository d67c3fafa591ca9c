// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"
#include "tools/fem/certificate/discretisation_error.hpp"

namespace palpate {
namespace {

using namespace fem;

constexpr ElementOrder element_orders[]{ElementOrder::linear, ElementOrder::quadratic};

double error_of_cube(int cells, ElementOrder order) {
    DeformableBody body = test::held_block({cells, cells, cells}, {10, 10, 10},
                                           {.youngs_modulus = 6e-3, .poissons_ratio = 0.3});
    body.element_order = order;
    return estimate_discretisation_error(prepared_body(std::move(body)));
}

TEST(DiscretisationError, is_a_part_of_the_work) {
    for (const ElementOrder order : element_orders) {
        const double error = error_of_cube(3, order);
        EXPECT_GT(error, 0);
        EXPECT_LT(error, 1);
    }
}

// Not as the square of the cells' size: contacts are on neighbouring nodes, so they shrink with the cells.
TEST(DiscretisationError, falls_with_the_cells_size) {
    for (const ElementOrder order : element_orders)
        EXPECT_LT(error_of_cube(4, order), 0.75 * error_of_cube(2, order));
    EXPECT_LT(error_of_cube(6, ElementOrder::linear), 0.9 * error_of_cube(4, ElementOrder::linear));
}

TEST(DiscretisationError, of_quadratic_elements_is_far_below_that_of_linear_ones) {
    for (const int cells : {2, 4})
        EXPECT_LT(error_of_cube(cells, ElementOrder::quadratic),
                  error_of_cube(cells, ElementOrder::linear) / 4);
}

// A plate as good as rigid on a thin soft layer moves by what the load sums up to, and turns by its moment;
// the layer follows within any elements. So the works on both elements agree if, and only if, they carry as
// much load.
TEST(DiscretisationError, compares_elements_under_the_same_load) {
    for (const ElementOrder order : element_orders) {
        DeformableBody body =
            test::held_block({8, 8, 2}, {80, 80, 2}, {.youngs_modulus = 6e3, .poissons_ratio = 0});
        body.element_order = order;
        body.mesh.region_names.push_back({2, "layer", {0, 1, 0}});
        for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
            double height = 0;
            for (const std::int32_t node : body.mesh.tetrahedra[t])
                height += body.mesh.rest_positions[static_cast<std::size_t>(node)].z() / 4;
            if (height < 1) body.mesh.regions[t] = 2;
        }
        body.materials.push_back({2, {.youngs_modulus = 6e-6, .poissons_ratio = 0}});
        const double error = estimate_discretisation_error(prepared_body(std::move(body)));
        EXPECT_GT(error, 0);
        EXPECT_LT(error, 0.03) << static_cast<int>(order);
    }
}

}  // namespace
}  // namespace palpate
