// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/hdf5/columns.hpp"

namespace palpate::asset {

MaterialColumns columns_of(const std::vector<RegionMaterial>& materials) {
    MaterialColumns columns;
    for (const RegionMaterial& entry : materials) {
        columns.regions.push_back(entry.region);
        columns.values.push_back({entry.material.youngs_modulus, entry.material.poissons_ratio});
    }
    return columns;
}

RelaxationColumns columns_of(const std::vector<RegionRelaxation>& relaxation) {
    RelaxationColumns columns;
    for (const RegionRelaxation& entry : relaxation) {
        columns.regions.push_back(entry.region);
        columns.values.push_back({entry.term.share, entry.term.time});
    }
    return columns;
}

LabelColumns columns_of(const std::vector<Label>& labels) {
    LabelColumns columns;
    for (const Label& label : labels) {
        columns.values.push_back(label.value);
        columns.names.push_back(label.name);
        columns.colours.push_back(label.colour);
    }
    return columns;
}

ObbColumns columns_of(const std::vector<ObbNode>& nodes) {
    ObbColumns columns;
    for (const ObbNode& node : nodes) {
        std::array<float, 9>& axes = columns.axes.emplace_back();
        Eigen::Map<Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(axes.data()) = node.axes;
        columns.centers.push_back({node.center.x(), node.center.y(), node.center.z()});
        columns.half_extents.push_back({node.half_extents.x(), node.half_extents.y(), node.half_extents.z()});
        columns.first.push_back(node.first);
        columns.count.push_back(node.count);
    }
    return columns;
}

BlockColumns columns_of(const std::vector<ComplianceBlock>& blocks) {
    BlockColumns columns;
    for (const ComplianceBlock& block : blocks) {
        columns.first_child.push_back(block.first_child);
        columns.rank.push_back(block.rank);
        columns.values.push_back(block.values);
        columns.factors.push_back(block.factors);
    }
    return columns;
}

}  // namespace palpate::asset
