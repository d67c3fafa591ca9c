// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstdint>
#include <string>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::asset {

/// The asset stores one array per field, not records; these are the two forms of the same values.

struct MaterialColumns {
    std::vector<std::int32_t> regions;          ///< label value of each material
    std::vector<std::array<double, 2>> values;  ///< Young's modulus in N/mm², Poisson's ratio
};
MaterialColumns columns_of(const std::vector<RegionMaterial>& materials);

struct RelaxationColumns {
    std::vector<std::int32_t> regions;          ///< label value of each term
    std::vector<std::array<double, 2>> values;  ///< share of Young's modulus, time in s
};
RelaxationColumns columns_of(const std::vector<RegionRelaxation>& relaxation);

struct LabelColumns {
    std::vector<std::int32_t> values;
    std::vector<std::string> names;
    std::vector<std::array<float, 3>> colours;
};
LabelColumns columns_of(const std::vector<Label>& labels);

struct ObbColumns {
    std::vector<std::array<float, 9>> axes;  ///< row by row
    std::vector<std::array<float, 3>> centers;
    std::vector<std::array<float, 3>> half_extents;
    std::vector<std::int32_t> first;
    std::vector<std::int32_t> count;
};
ObbColumns columns_of(const std::vector<ObbNode>& nodes);

struct BlockColumns {
    std::vector<std::int32_t> first_child, rank;
    std::vector<std::int64_t> values, factors;
};
BlockColumns columns_of(const std::vector<ComplianceBlock>& blocks);

}  // namespace palpate::asset
