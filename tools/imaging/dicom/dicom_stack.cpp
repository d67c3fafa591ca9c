// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/dicom/dicom_stack.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/read_image.hpp"

namespace palpate::imaging {
namespace {

constexpr double same_place = 1e-3;  // mm

std::vector<double> positions_of(std::span<const SlicePlace> places, const Eigen::Vector3d& normal) {
    std::vector<double> positions;
    for (const SlicePlace& place : places) positions.push_back(normal.dot(place.origin));
    return positions;
}

// The median distance between slices of different places, mm; 0 if all lie at one.
double usual_gap(std::span<const double> positions) {
    std::vector<double> gaps;
    for (std::size_t i = 1; i < positions.size(); ++i)
        if (positions[i] - positions[i - 1] > same_place) gaps.push_back(positions[i] - positions[i - 1]);
    std::ranges::sort(gaps);
    return gaps.empty() ? 0 : gaps[gaps.size() / 2];
}

// A slice seen from the output grid: shifted within its plane by so many voxels.
struct ShiftedSlice {
    double position = 0;
    Eigen::Vector2d shift;
    std::span<const float> values;
};

float sample(const ShiftedSlice& slice, const ImageGrid& grid, double i, double j, float outside) {
    constexpr double edge = 1e-6;
    const double x = i - slice.shift[0], y = j - slice.shift[1];
    const int columns = grid.size[0], rows = grid.size[1];
    if (x < -edge || y < -edge || x > columns - 1 + edge || y > rows - 1 + edge) return outside;
    const int x0 = std::clamp(static_cast<int>(x), 0, columns - 2),
              y0 = std::clamp(static_cast<int>(y), 0, rows - 2);
    const auto at = [&](int column, int row) { return double{slice.values[row * columns + column]}; };
    const double u = std::clamp(x - x0, 0.0, 1.0), v = std::clamp(y - y0, 0.0, 1.0);
    return static_cast<float>((1 - v) * ((1 - u) * at(x0, y0) + u * at(x0 + 1, y0)) +
                              v * ((1 - u) * at(x0, y0 + 1) + u * at(x0 + 1, y0 + 1)));
}

// Slices at distinct places, ascending; of identical ones at a place the first.
std::vector<ShiftedSlice> distinct_slices(const Volume& volume, std::span<const SlicePlace> places,
                                          const std::filesystem::path& path) {
    const ImageGrid& grid = volume.grid;
    const std::size_t count = grid.voxel_count() / static_cast<std::size_t>(grid.size[2]);
    const std::vector<double> positions = positions_of(places, grid.direction.col(2));
    std::vector<ShiftedSlice> slices;
    for (std::size_t k = 0; k < places.size(); ++k) {
        const Eigen::Vector3d offset = grid.direction.transpose() * (places[k].origin - places[0].origin);
        const ShiftedSlice slice{positions[k], offset.head<2>().cwiseQuotient(grid.spacing.head<2>()),
                                 std::span(volume.values).subspan(k * count, count)};
        if (slices.empty() || slice.position - slices.back().position > same_place)
            slices.push_back(slice);
        else if (!std::ranges::equal(slice.values, slices.back().values))
            throw InvalidInput(
                {path.string(),
                 fmt::format("{} and {} lie at one place and differ", places[k - 1].name, places[k].name),
                 "one slice per place", "keep one phase or reconstruction of the series"});
    }
    if (slices.size() < 2)
        throw InvalidInput(
            {path.string(), "all slices lie at one place", "a stack", "choose another series"});
    return slices;
}

// Slices that each lie well beside their neighbour may yet leave the even grid together.
void find_drift(StackFault& fault, std::span<const SlicePlace> places, const Eigen::Vector3d& normal,
                double pixel) {
    for (std::size_t k = 1; k < places.size(); ++k) {
        const Eigen::Vector3d path = places[k].origin - places[0].origin;
        const double along = normal.dot(path), off = along - static_cast<double>(k) * fault.mean_gap,
                     sideways = (path - along * normal).norm();
        if (sideways > 0.5 * pixel) {
            fault.found = fmt::format(
                "slices are shifted sideways by {:.3f} mm in all (gantry tilt of {:.1f} degrees) between {} "
                "and {}",
                sideways, std::atan2(sideways, along) * 180 / std::numbers::pi, places[0].name,
                places[k].name);
            fault.expected = "slices stacked along their normal";
            fault.next_step = "resample the series";
        } else if (std::abs(off) > 0.5 * fault.mean_gap) {
            fault.found = fmt::format(
                "{} lies {:.3f} mm off its place in an even stack, at {:.2f} mm along "
                "the normal: the spacing changes",
                places[k].name, std::abs(off), normal.dot(places[k].origin));
            fault.expected = fmt::format("{:.3f} mm between all slices", fault.mean_gap);
            fault.next_step = "choose a series of even spacing";
        } else {
            continue;
        }
        return;
    }
}

}  // namespace

StackFault find_stack_fault(std::span<const SlicePlace> places, const Eigen::Vector3d& normal, double pixel) {
    const std::vector<double> positions = positions_of(places, normal);
    const double usual = usual_gap(positions);
    StackFault fault;
    fault.mean_gap = (positions.back() - positions.front()) / static_cast<double>(positions.size() - 1);
    for (std::size_t i = 1; i < places.size() && fault.found.empty(); ++i) {
        const double gap = positions[i] - positions[i - 1];
        const auto at = fmt::format("between the slices at {:.2f} and {:.2f} mm along the normal, {} and {}",
                                    positions[i - 1], positions[i], places[i - 1].name, places[i].name);
        if (gap <= same_place) {
            fault.found = "two slices lie at one place, " + at;
            fault.expected = "one slice per place";
            fault.next_step = "keep one phase or reconstruction of the series";
        } else if (std::abs(gap - usual) > std::max(0.02 * usual, 0.011)) {
            fault.found = fmt::format("{:.3f} mm {}", gap, at);
            fault.expected = fmt::format("{:.3f} mm as elsewhere", usual);
            fault.next_step = "add the missing slices";
        } else if (const Eigen::Vector3d step = places[i].origin - places[i - 1].origin;
                   (step - gap * normal).norm() > 0.02 * usual) {
            fault.found =
                fmt::format("slices are shifted sideways by {:.3f} mm (gantry tilt of {:.1f} degrees) {}",
                            (step - gap * normal).norm(),
                            std::acos(std::clamp(gap / step.norm(), -1.0, 1.0)) * 180 / std::numbers::pi, at);
            fault.expected = "slices stacked along their normal";
            fault.next_step = "resample the series";
        }
    }
    if (fault.found.empty()) find_drift(fault, places, normal, pixel);
    return fault;
}

Volume resample_stack(const Volume& volume, std::span<const SlicePlace> places,
                      const std::filesystem::path& path, const NoteSink& note) {
    const ImageGrid& from = volume.grid;
    std::vector<ShiftedSlice> slices = distinct_slices(volume, places, path);
    std::vector<double> positions;
    Eigen::Vector2d low(0, 0), high(0, 0);
    for (const ShiftedSlice& slice : slices) {
        positions.push_back(slice.position);
        low = low.cwiseMin(slice.shift);
        high = high.cwiseMax(slice.shift);
    }
    const double length = positions.back() - positions.front();
    const double steps = std::max(1.0, std::round(length / usual_gap(positions)));

    Volume result;
    result.grid = from;
    // Whole voxels, so that slices that are not shifted keep their values.
    low = (low.array() + 1e-3).floor();
    high = (high.array() - 1e-3).ceil();
    for (std::size_t axis = 0; axis < 2; ++axis) {
        const auto row = static_cast<Eigen::Index>(axis);
        result.grid.size[axis] += static_cast<std::int32_t>(high[row] - low[row]);
    }
    result.grid.size[2] = static_cast<std::int32_t>(steps) + 1;
    result.grid.spacing[2] = length / steps;
    result.grid.origin =
        from.origin + from.direction.leftCols<2>() * from.spacing.head<2>().cwiseProduct(low);
    check_size({result.grid.size[0], result.grid.size[1], result.grid.size[2]}, path);
    for (ShiftedSlice& slice : slices) slice.shift -= low;

    const float outside = std::ranges::min(volume.values);
    result.values.reserve(result.grid.voxel_count());
    std::size_t above = 1;
    for (std::int32_t k = 0; k < result.grid.size[2]; ++k) {
        const double position = positions.front() + k * result.grid.spacing[2];
        while (above + 1 < slices.size() && positions[above] < position) ++above;
        const double weight = std::clamp(
            (position - positions[above - 1]) / (positions[above] - positions[above - 1]), 0.0, 1.0);
        for (std::int32_t j = 0; j < result.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < result.grid.size[0]; ++i)
                result.values.push_back(
                    static_cast<float>((1 - weight) * sample(slices[above - 1], from, i, j, outside) +
                                       weight * sample(slices[above], from, i, j, outside)));
    }
    const std::size_t doubled = places.size() - slices.size();
    if (note)
        note(fmt::format("{} slices interpolated onto {} even, untilted ones {:.4g} mm apart{}",
                         slices.size(), result.grid.size[2], result.grid.spacing[2],
                         doubled > 0 ? fmt::format("; {} doubled ones left out", doubled) : ""));
    return result;
}

}  // namespace palpate::imaging
