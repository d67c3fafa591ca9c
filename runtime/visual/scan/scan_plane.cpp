// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/scan/scan_plane.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <fmt/format.h>
#include <vector>

#include "formats/records/shown_text.hpp"
#include "runtime/texts/translated.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

// Where voxels are, to their outer faces, along the axes of P.
Eigen::AlignedBox3d extent_of(const ImageGrid& grid) {
    Eigen::AlignedBox3d box;
    for (int corner = 0; corner < 8; ++corner) {
        Vector3d index;
        for (int axis = 0; axis < 3; ++axis)
            index[axis] = ((corner >> axis & 1) != 0 ? grid.size[axis] : 0) - 0.5;
        box.extend(grid.point_of(index));
    }
    return box;
}

// Of a plane: the axis that it lies across, and those to the right and up as radiologists look at it.
struct Axes {
    const char* name;
    const char *below, *above;  // what lies on either side of 0
    int across;
    Vector3d right, up;
};

const Axes& axes_of(SlicePlane plane) {
    static const std::array<Axes, 3> axes{{{shown_text("axial"), shown_text("inferior"),
                                            shown_text("superior"), 2, Vector3d::UnitX(), -Vector3d::UnitY()},
                                           {shown_text("coronal"), shown_text("anterior"),
                                            shown_text("posterior"), 1, Vector3d::UnitX(), Vector3d::UnitZ()},
                                           {shown_text("sagittal"), shown_text("right"), shown_text("left"),
                                            0, Vector3d::UnitY(), Vector3d::UnitZ()}}};
    return axes[static_cast<std::size_t>(plane)];
}

}  // namespace

ScanPlane slice_through(const ImageGrid& grid, SlicePlane plane, const Vector3d& p) {
    const auto& [name, below, above, across, right, up] = axes_of(plane);
    const Eigen::AlignedBox3d box = extent_of(grid);
    const Vector3d half = box.sizes() / 2, here = p.cwiseMax(box.min()).cwiseMin(box.max());
    Vector3d middle = box.center();
    middle[across] = here[across];
    const double width = 2 * half.dot(right.cwiseAbs()), height = 2 * half.dot(up.cwiseAbs());
    return {middle - right * (width / 2) - up * (height / 2), right, up, width, height};
}

std::string slice_text(SlicePlane plane, const ScanPlane& slice) {
    const Axes& axes = axes_of(plane);
    const double at = slice.corner[axes.across];
    return fmt::format("{}, {:.1f} mm {}", texts::looked_up(axes.name), std::abs(at),
                       texts::looked_up(at < 0 ? axes.below : axes.above));
}

GreyWindow grey_window(const Scan& scan) {
    constexpr double level = 40, width = 400;  // HU
    if (scan.hounsfield) return {level - width / 2, level + width / 2};
    constexpr int values = 65536, lowest = -32768;
    std::vector<std::size_t> counts(values, 0);
    for (const std::int16_t value : scan.values) ++counts[value - lowest];
    const auto percentile = [&](double share) {
        const double wanted = share * static_cast<double>(scan.values.size());
        std::size_t below = 0;
        int value = lowest;
        while (value < lowest + values - 1 && static_cast<double>(below += counts[value - lowest]) <= wanted)
            ++value;
        return static_cast<double>(value);
    };
    const double black = percentile(0.01);
    return {black, std::max(percentile(0.99), black + 1)};
}

}  // namespace palpate::visual
