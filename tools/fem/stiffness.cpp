// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/stiffness.hpp"

#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <map>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

struct Lame {
    double lambda;  // N/mm²
    double mu;      // N/mm²
};

Lame lame_parameters(const Material& material) {
    const double e = material.youngs_modulus, nu = material.poissons_ratio;
    return {e * nu / ((1 + nu) * (1 - 2 * nu)), e / (2 * (1 + nu))};
}

struct Element {
    std::array<Eigen::Vector3d, 4> gradients;  // of the shape functions, 1/mm
    double volume;                             // mm³
};

Element element_of(const std::array<Eigen::Vector3d, 4>& p) {
    Eigen::Matrix3d edges;
    edges << p[1] - p[0], p[2] - p[0], p[3] - p[0];
    const Eigen::Matrix3d inverse = edges.inverse();
    Element element;
    for (int a = 0; a < 3; ++a)
        element.gradients[static_cast<std::size_t>(a) + 1] = inverse.row(a).transpose();
    element.gradients[0] = -(element.gradients[1] + element.gradients[2] + element.gradients[3]);
    element.volume = edges.determinant() / 6;
    return element;
}

Eigen::Matrix3d block(const Element& element, const Lame& lame, std::size_t a, std::size_t b) {
    const Eigen::Vector3d &ga = element.gradients[a], &gb = element.gradients[b];
    return element.volume * (lame.lambda * ga * gb.transpose() + lame.mu * gb * ga.transpose() +
                             lame.mu * ga.dot(gb) * Eigen::Matrix3d::Identity());
}

std::array<Eigen::Vector3d, 4> corners(const TetMesh& mesh, std::size_t t) {
    std::array<Eigen::Vector3d, 4> points;
    for (std::size_t c = 0; c < 4; ++c)
        points[c] = mesh.rest_positions[static_cast<std::size_t>(mesh.tetrahedra[t][c])];
    return points;
}

std::string region_name(const TetMesh& mesh, std::int32_t value) {
    for (const Label& label : mesh.region_names)
        if (label.value == value) return label.name;
    return "region " + std::to_string(value);
}

std::map<std::int32_t, Lame> checked_materials(const TetMesh& mesh,
                                               std::span<const RegionMaterial> materials) {
    std::map<std::int32_t, Lame> lame;
    for (const auto& [region, material] : materials) {
        const std::string culprit = "material of " + region_name(mesh, region);
        if (!(material.youngs_modulus > 0))
            throw InvalidInput({culprit,
                                "Young's modulus " + std::to_string(material.youngs_modulus * 1e3) + " kPa",
                                "more than 0", "set youngs_modulus_kpa"});
        if (!(material.poissons_ratio > -1 && material.poissons_ratio < 0.5))
            throw InvalidInput({culprit, "Poisson's ratio " + std::to_string(material.poissons_ratio),
                                "between -1 and 0.5, both excluded", "soft tissue is usually 0.45 to 0.49"});
        if (!lame.try_emplace(region, lame_parameters(material)).second)
            throw InvalidInput({culprit, "given twice", "one material a region", "leave one out"});
    }
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        if (!lame.contains(mesh.regions[t]))
            throw InvalidInput({"region '" + region_name(mesh, mesh.regions[t]) + "'", "has no material", "",
                                "give it a Young's modulus and a Poisson's ratio"});
        if (!(six_volume(mesh, t) > 0))
            throw InvalidInput({"tetrahedron " + std::to_string(t),
                                "its volume is " + std::to_string(six_volume(mesh, t) / 6) + " mm³",
                                "more than 0", "mesh again, or reorder its nodes"});
    }
    return lame;
}

// For each node position, the positions >= it that share a tetrahedron with it, itself first, ascending.
std::vector<std::vector<std::int32_t>> lower_neighbours(const TetMesh& mesh,
                                                        std::span<const std::int32_t> position_of_node,
                                                        std::size_t position_count) {
    std::vector<std::vector<std::int32_t>> neighbours(position_count);
    for (const Tetrahedron& tet : mesh.tetrahedra)
        for (const std::int32_t a : tet)
            for (const std::int32_t b : tet) {
                const std::int32_t column = position_of_node[static_cast<std::size_t>(a)];
                const std::int32_t row = position_of_node[static_cast<std::size_t>(b)];
                if (column >= 0 && row >= column) neighbours[static_cast<std::size_t>(column)].push_back(row);
            }
    for (auto& list : neighbours) {
        std::ranges::sort(list);
        list.erase(std::unique(list.begin(), list.end()), list.end());
        list.shrink_to_fit();
    }
    return neighbours;
}

}  // namespace

Eigen::Matrix<double, 12, 12> tetrahedron_stiffness(const std::array<Eigen::Vector3d, 4>& points,
                                                    const Material& material) {
    const Element element = element_of(points);
    const Lame lame = lame_parameters(material);
    Eigen::Matrix<double, 12, 12> stiffness;
    for (int a = 0; a < 4; ++a)
        for (int b = 0; b < 4; ++b)
            stiffness.block<3, 3>(3 * a, 3 * b) =
                block(element, lame, static_cast<std::size_t>(a), static_cast<std::size_t>(b));
    return stiffness;
}

std::vector<std::int32_t> number_free_nodes(std::size_t node_count,
                                            std::span<const std::int32_t> fixed_nodes) {
    std::vector<std::int32_t> position(node_count, 0);
    for (const std::int32_t node : fixed_nodes) position[static_cast<std::size_t>(node)] = -1;
    std::int32_t next = 0;
    for (std::int32_t& p : position)
        if (p >= 0) p = next++;
    return position;
}

LowerSparse assemble_stiffness(const TetMesh& mesh, std::span<const RegionMaterial> materials,
                               std::span<const std::int32_t> position_of_node) {
    const auto lame = checked_materials(mesh, materials);
    const auto count =
        static_cast<std::size_t>(std::ranges::count_if(position_of_node, [](auto p) { return p >= 0; }));
    const auto neighbours = lower_neighbours(mesh, position_of_node, count);

    // The pattern: column 3p + c holds, of each neighbour's 3 rows, those not above the diagonal.
    const auto n = static_cast<std::int64_t>(3 * count);
    LowerSparse stiffness(n, n);
    std::int64_t entries = 0;
    for (const auto& list : neighbours) entries += 9 * static_cast<std::int64_t>(list.size()) - 3;
    stiffness.resizeNonZeros(entries);
    std::int64_t* outer = stiffness.outerIndexPtr();
    std::int64_t* inner = stiffness.innerIndexPtr();
    std::int64_t cursor = 0;
    for (std::size_t p = 0; p < count; ++p)
        for (std::int64_t c = 0; c < 3; ++c) {
            outer[3 * p + static_cast<std::size_t>(c)] = cursor;
            for (const std::int32_t row : neighbours[p])
                for (std::int64_t r = 0; r < 3; ++r)
                    if (3 * std::int64_t{row} + r >= 3 * static_cast<std::int64_t>(p) + c)
                        inner[cursor++] = 3 * std::int64_t{row} + r;
        }
    outer[3 * count] = cursor;
    std::fill_n(stiffness.valuePtr(), entries, 0.0);

    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        const Element element = element_of(corners(mesh, t));
        const Lame& material = lame.at(mesh.regions[t]);
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = 0; b < 4; ++b) {
                const std::int32_t column = position_of_node[static_cast<std::size_t>(mesh.tetrahedra[t][a])];
                const std::int32_t row = position_of_node[static_cast<std::size_t>(mesh.tetrahedra[t][b])];
                if (column < 0 || row < column) continue;
                const auto& list = neighbours[static_cast<std::size_t>(column)];
                const auto rank = std::ranges::lower_bound(list, row) - list.begin();
                const Eigen::Matrix3d values = block(element, material, b, a);
                for (std::int64_t c = 0; c < 3; ++c)
                    for (std::int64_t r = (row == column ? c : 0); r < 3; ++r)
                        stiffness.valuePtr()[outer[3 * std::int64_t{column} + c] + 3 * rank + r - c] +=
                            values(r, c);
            }
    }
    return stiffness;
}

}  // namespace palpate
