// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/discretisation_error.hpp"

#include <gtest/gtest.h>

#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/compliances.hpp"

namespace palpate {
namespace {

constexpr Material soft{.youngs_modulus = 6e-3, .poissons_ratio = 0.3};

DeformableBody cube(int cells, ElementOrder order) {
    DeformableBody body = test::held_block({cells, cells, cells}, {10, 10, 10}, soft);
    body.element_order = order;
    return prepared_body(std::move(body));
}

TEST(DiscretisationError, is_a_part_of_the_work) {
    for (const ElementOrder order : {ElementOrder::linear, ElementOrder::quadratic}) {
        const double error = estimate_discretisation_error(cube(3, order));
        EXPECT_GT(error, 0);
        EXPECT_LT(error, 1);
        printf("order %d: %g\n", int(order), error);
    }
}

TEST(DiscretisationError, probe) {
    for (int n : {2, 4, 8})
        printf("n %d %g\n", n, estimate_discretisation_error(cube(n, ElementOrder::linear)));
    for (int n : {2, 4})
        printf("q n %d %g\n", n, estimate_discretisation_error(cube(n, ElementOrder::quadratic)));
    for (auto order : {ElementOrder::linear, ElementOrder::quadratic})
        for (int n : {2, 4, 6}) {
            DeformableBody body =
                test::held_block({n, n, n}, {10, 10, 10}, {.youngs_modulus = 6e3, .poissons_ratio = 0.3});
            body.element_order = order;
            body.mesh.region_names.push_back({2, "base", {0, 1, 0}});
            for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
                double z = 0;
                for (auto node : body.mesh.tetrahedra[t])
                    z += body.mesh.rest_positions[std::size_t(node)].z() / 4;
                if (z < 10.0 / n) body.mesh.regions[t] = 2;
            }
            body.materials.push_back({2, {.youngs_modulus = 6e-3, .poissons_ratio = 0.0}});
            printf("stiff %d n %d %g\n", int(order), n, estimate_discretisation_error(prepared_body(body)));
        }
}

}  // namespace
}  // namespace palpate
