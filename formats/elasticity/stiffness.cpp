// SPDX-License-Identifier: Apache-2.0
#include "formats/elasticity/stiffness.hpp"

#include <algorithm>
#include <map>
#include <ranges>
#include <set>
#include <string>

#include "formats/elasticity/shape_gradients.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/regions.hpp"

namespace palpate::elasticity {
namespace {

struct Lame {
    double lambda;  // N/mm²
    double mu;      // N/mm²
};

Lame lame_parameters(const Material& material) {
    const double e = material.youngs_modulus, nu = material.poissons_ratio;
    return {e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))};
}

using ElementStiffness = Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::ColMajor, 30, 30>;

// The integral of g_a g_bᵀ for all nodes a, b.
ElementStiffness integral_of_gradient_products(const TetrahedronShape& shape, int nodes_per_element) {
    if (nodes_per_element == 4) {
        const auto gradients = shape.gradients.reshaped();
        return shape.volume * gradients * gradients.transpose();
    }
    Eigen::Matrix<double, 30, 4> gradients;
    for (Eigen::Index q = 0; q < 4; ++q)
        gradients.col(q) = quadratic_gradients(shape.gradients, quadrature_point(q)).reshaped();
    return shape.volume / 4 * gradients * gradients.transpose();
}

ElementStiffness element_stiffness(const std::array<Eigen::Vector3d, 4>& corners, const Lame& lame,
                                   int nodes_per_element) {
    const ElementStiffness products = integral_of_gradient_products(shape_of(corners), nodes_per_element);
    ElementStiffness stiffness = lame.lambda * products;
    for (Eigen::Index a = 0; a < products.rows(); a += 3)
        for (Eigen::Index b = 0; b < products.cols(); b += 3) {
            const Eigen::Matrix3d product = products.block<3, 3>(a, b);
            stiffness.block<3, 3>(a, b) += lame.mu * product.transpose();
            stiffness.block<3, 3>(a, b).diagonal().array() += lame.mu * product.trace();
        }
    return stiffness;
}

}  // namespace

void require_sound_materials(const TetMesh& mesh, std::span<const RegionMaterial> materials) {
    std::set<std::int32_t> known;
    for (const auto& [region, material] : materials) {
        const std::string culprit = "material of " + region_name(mesh, region);
        if (!(material.youngs_modulus > 0))
            throw InvalidInput({culprit,
                                "Young's modulus " + std::to_string(material.youngs_modulus * 1e3) + " kPa",
                                "more than 0", "set youngs_modulus_kpa"});
        if (!(material.poissons_ratio > -1 && material.poissons_ratio < 0.5))
            throw InvalidInput({culprit, "Poisson's ratio " + std::to_string(material.poissons_ratio),
                                "between -1 and 0.5, both excluded", "soft tissue is usually 0.45 to 0.49"});
        if (!known.insert(region).second)
            throw InvalidInput({culprit, "given twice", "one material a region", "leave one out"});
    }
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (!known.contains(mesh.regions[t]))
            throw InvalidInput({"region '" + region_name(mesh, mesh.regions[t]) + "'", "has no material", "",
                                "give it a Young's modulus and a Poisson's ratio"});
}

Eigen::MatrixXd tetrahedron_stiffness(const std::array<Eigen::Vector3d, 4>& corners, const Material& material,
                                      ElementOrder order) {
    return element_stiffness(corners, lame_parameters(material), order == ElementOrder::linear ? 4 : 10);
}

std::vector<std::int32_t> number_free_nodes(std::size_t node_count,
                                            std::span<const std::int32_t> fixed_nodes) {
    std::vector<std::int32_t> position(node_count, 0);
    for (const std::int32_t node : fixed_nodes) position[node] = -1;
    std::int32_t next = 0;
    for (std::int32_t& p : position)
        if (p >= 0) p = next++;
    return position;
}

LowerSparse assemble_stiffness(const TetMesh& mesh, std::span<const RegionMaterial> materials,
                               const Discretisation& discretisation,
                               std::span<const std::int32_t> position_of_node) {
    require_sound_materials(mesh, materials);
    std::map<std::int32_t, Lame> lame;
    for (const auto& [region, material] : materials) lame[region] = lame_parameters(material);
    const NodeGraph graph = node_graph(discretisation, position_of_node);
    const std::size_t count = graph.offsets.size() - 1;
    // The lower triangle's neighbours of a position: itself and those after it.
    const auto below = [&](std::size_t p) {
        const auto begin = graph.neighbours.begin();
        return std::ranges::subrange(std::lower_bound(begin + graph.offsets[p], begin + graph.offsets[p + 1],
                                                      static_cast<std::int32_t>(p)),
                                     begin + graph.offsets[p + 1]);
    };

    // The pattern: column 3p + c holds, of each neighbour's 3 rows, those not above the diagonal.
    const auto n = static_cast<std::int64_t>(3 * count);
    LowerSparse stiffness(n, n);
    std::int64_t entries = 0;
    for (std::size_t p = 0; p < count; ++p) entries += 9 * std::ssize(below(p)) - 3;
    stiffness.resizeNonZeros(entries);
    std::int64_t* outer = stiffness.outerIndexPtr();
    std::int64_t* inner = stiffness.innerIndexPtr();
    std::int64_t cursor = 0;
    for (std::size_t p = 0; p < count; ++p)
        for (std::int64_t c = 0; c < 3; ++c) {
            outer[3 * p + static_cast<std::size_t>(c)] = cursor;
            for (const std::int32_t row : below(p))
                for (std::int64_t r = 0; r < 3; ++r)
                    if (3 * std::int64_t{row} + r >= 3 * static_cast<std::int64_t>(p) + c)
                        inner[cursor++] = 3 * std::int64_t{row} + r;
        }
    outer[3 * count] = cursor;
    std::fill_n(stiffness.valuePtr(), entries, 0.0);

    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const ElementStiffness element = element_stiffness(corners_of(mesh, t), lame.at(mesh.regions[t]),
                                                           discretisation.nodes_per_element);
        const auto nodes = nodes_of_element(discretisation, t);
        for (std::size_t a = 0; a < nodes.size(); ++a)
            for (std::size_t b = 0; b < nodes.size(); ++b) {
                const std::int32_t column = position_of_node[nodes[a]];
                const std::int32_t row = position_of_node[nodes[b]];
                if (column < 0 || row < column) continue;
                const auto list = below(static_cast<std::size_t>(column));
                const auto rank = std::ranges::lower_bound(list, row) - list.begin();
                const Eigen::Matrix3d values =
                    element.block<3, 3>(3 * static_cast<Eigen::Index>(b), 3 * static_cast<Eigen::Index>(a));
                for (std::int64_t c = 0; c < 3; ++c)
                    for (std::int64_t r = (row == column ? c : 0); r < 3; ++r)
                        stiffness.valuePtr()[outer[3 * std::int64_t{column} + c] + 3 * rank + r - c] +=
                            values(r, c);
            }
    }
    return stiffness;
}

}  // namespace palpate::elasticity
