// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/pictures/slice_targets.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cassert>
#include <cmath>
#include <limits>
#include <map>

namespace palpate::report {

using Eigen::Vector3d;

std::vector<SliceTarget> label_targets(const LabelMap& map) {
    struct Extent {
        Vector3d sum = Vector3d::Zero();
        std::int64_t voxels = 0;
        Eigen::AlignedBox3d box;
        Vector3d nearest = Vector3d::Zero();
        double squared_distance = std::numeric_limits<double>::infinity();
    };
    std::map<std::uint16_t, Extent> extents;
    const auto visit = [&](const auto& function) {
        std::size_t offset = 0;
        for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
            for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
                for (std::int32_t i = 0; i < map.grid.size[0]; ++i, ++offset)
                    if (map.labels[offset] != 0)
                        function(extents[map.labels[offset]], map.grid.point_of({1.0 * i, 1.0 * j, 1.0 * k}));
    };
    visit([](Extent& extent, const Vector3d& p) {
        extent.sum += p;
        ++extent.voxels;
        extent.box.extend(p);
    });
    visit([](Extent& extent, const Vector3d& p) {
        const double squared = (p - extent.sum / static_cast<double>(extent.voxels)).squaredNorm();
        if (squared >= extent.squared_distance) return;
        extent.squared_distance = squared;
        extent.nearest = p;
    });
    std::vector<SliceTarget> targets;
    for (const Label& label : map.names)
        if (const auto found = extents.find(static_cast<std::uint16_t>(label.value)); found != extents.end())
            targets.push_back({found->second.nearest, found->second.box.center(),
                               1.3 * found->second.box.sizes().maxCoeff() + 10, label.name});
    return targets;
}

SliceTarget whole_target(const LabelMap& map) {
    LabelMap whole{map.grid, map.labels, {Label{.value = 1, .name = "all structures"}}};
    for (std::uint16_t& label : whole.labels) label = label != 0;
    const std::vector<SliceTarget> targets = label_targets(whole);
    assert(!targets.empty());
    return targets.front();
}

PlaneText plane_text(Plane plane) {
    if (plane == Plane::axial) return {"Axial", "R", "L", "A", "P", 2, "S"};
    if (plane == Plane::coronal) return {"Coronal", "R", "L", "S", "I", 1, "P"};
    return {"Sagittal", "A", "P", "S", "I", 0, "L"};
}

double scale_bar_length(double side) {
    const double decade = std::pow(10, std::floor(std::log10(side / 4)));
    for (const double step : {5.0, 2.0})
        if (step * decade <= side / 4) return step * decade;
    return decade;
}

}  // namespace palpate::report
