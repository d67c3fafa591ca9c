// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/pictures/slices.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <optional>

namespace palpate::report {
namespace {

struct Neighbour {
    std::size_t offset;
    double weight;
};

// The eight voxels around an index with their trilinear weights; none outside the grid.
std::optional<std::array<Neighbour, 8>> neighbours(const ImageGrid& grid, const Eigen::Vector3d& index) {
    std::array<std::array<std::int32_t, 2>, 3> side{};
    std::array<double, 3> part{};
    for (int axis = 0; axis < 3; ++axis) {
        const auto a = static_cast<std::size_t>(axis);
        const std::int32_t last = grid.size[a] - 1;
        // Half a voxel around the outermost centres still belongs to the image.
        if (index[axis] < -0.5 || index[axis] > last + 0.5) return std::nullopt;
        const double inside = std::clamp(index[axis], 0.0, static_cast<double>(last));
        side[a][0] = static_cast<std::int32_t>(inside);
        side[a][1] = std::min(side[a][0] + 1, last);
        part[a] = inside - side[a][0];
    }
    std::array<Neighbour, 8> result{};
    for (std::size_t corner = 0; corner < 8; ++corner) {
        const std::array<std::size_t, 3> up{corner & 1, corner >> 1 & 1, corner >> 2 & 1};
        double weight = 1;
        for (std::size_t a = 0; a < 3; ++a) weight *= up[a] ? part[a] : 1 - part[a];
        result[corner] = {grid.offset(side[0][up[0]], side[1][up[1]], side[2][up[2]]), weight};
    }
    return result;
}

// The label with the largest share of an index: contours come out smooth, not as stairs of voxels.
std::uint16_t label_at(const LabelMap& map, const Eigen::Vector3d& index) {
    const auto around = neighbours(map.grid, index);
    if (!around) return 0;
    std::uint16_t best = map.labels[around->front().offset];
    if (std::ranges::all_of(*around,
                            [&](const Neighbour& other) { return map.labels[other.offset] == best; }))
        return best;
    double best_share = 0;
    for (const Neighbour& candidate : *around) {
        const std::uint16_t label = map.labels[candidate.offset];
        double share = 0;
        for (const Neighbour& other : *around)
            if (map.labels[other.offset] == label) share += other.weight;
        if (share > best_share || (share == best_share && label < best)) {
            best = label;
            best_share = share;
        }
    }
    return best;
}

std::array<float, 3> colour_of(const LabelMap& map, std::uint16_t value) {
    const auto label = std::ranges::find(map.names, std::int32_t{value}, &Label::value);
    return label != map.names.end() ? label->colour : default_label_colour(value);
}

float grey_at(const Volume& volume, const GreyWindow& grey, const Eigen::Vector3d& index) {
    const auto around = neighbours(volume.grid, index);
    if (!around) return 0;
    double value = 0;
    for (const Neighbour& voxel : *around) value += voxel.weight * volume.values[voxel.offset];
    return std::clamp((static_cast<float>(value) - grey.black) / (grey.white - grey.black), 0.0F, 1.0F);
}

// The indices of a window's pixels in a grid; an index depends on the place as a line does.
class PixelIndices {
  public:
    PixelIndices(const SliceWindow& window, const ImageGrid& grid) {
        const double pixel = window.side / window.pixels, middle = (window.pixels - 1) / 2.0;
        const Eigen::Vector3d right = pixel * window.right(), down = pixel * window.down();
        const Eigen::Vector3d first = window.center - middle * (right + down);
        first_ = grid.index_of(first);
        right_ = grid.index_of(first + right) - first_;
        down_ = grid.index_of(first + down) - first_;
    }
    Eigen::Vector3d at(int x, int y) const { return first_ + x * right_ + y * down_; }

  private:
    Eigen::Vector3d first_, right_, down_;
};

}  // namespace

Eigen::Vector3d SliceWindow::right() const {
    return plane == Plane::sagittal ? Eigen::Vector3d::UnitY() : Eigen::Vector3d::UnitX();
}

Eigen::Vector3d SliceWindow::down() const {
    return plane == Plane::axial ? Eigen::Vector3d::UnitY() : Eigen::Vector3d(-Eigen::Vector3d::UnitZ());
}

Eigen::Vector3d SliceWindow::normal() const {
    return right().cross(down());
}

Eigen::Vector2d SliceWindow::pixel_of(const Eigen::Vector3d& p_P) const {
    const Eigen::Vector3d r = (p_P - center) * (pixels / side);
    return {r.dot(right()) + pixels / 2.0, r.dot(down()) + pixels / 2.0};
}

GreyWindow grey_window(const Volume& volume) {
    if (volume.values.empty()) return {};
    std::vector<float> sorted = volume.values;
    const auto percentile = [&](double p) {
        const auto at =
            sorted.begin() + static_cast<std::ptrdiff_t>(p * static_cast<double>(sorted.size() - 1));
        std::ranges::nth_element(sorted, at);
        return *at;
    };
    if (std::ranges::min(sorted) <= -500) return {-250, 650, true};
    const float black = percentile(0.01), white = percentile(0.99);
    return {black, std::max(white, black + 1e-6F), false};
}

Picture slice_picture(const SliceWindow& window, const Volume* volume, const LabelMap* labels) {
    return slice_picture(window, volume, labels, volume ? grey_window(*volume) : GreyWindow{});
}

Picture slice_picture(const SliceWindow& window, const Volume* volume, const LabelMap* labels,
                      const GreyWindow& grey) {
    Picture picture{window.pixels, window.pixels, {}};
    picture.rgb.resize(picture.offset(0, window.pixels));
    const int n = window.pixels;
    const PixelIndices in_volume(window, volume ? volume->grid : ImageGrid{}),
        in_labels(window, labels ? labels->grid : ImageGrid{});
    const float paper = 0.16F;  // behind labels without a volume

    std::vector<std::uint16_t> label(static_cast<std::size_t>(n) * static_cast<std::size_t>(n), 0);
    const auto at = [&](int x, int y) -> std::uint16_t& {
        return label[static_cast<std::size_t>(std::clamp(y, 0, n - 1)) * static_cast<std::size_t>(n) +
                     static_cast<std::size_t>(std::clamp(x, 0, n - 1))];
    };
    if (labels)
        for (int y = 0; y < n; ++y)
            for (int x = 0; x < n; ++x) at(x, y) = label_at(*labels, in_labels.at(x, y));

    for (int y = 0; y < n; ++y)
        for (int x = 0; x < n; ++x) {
            const float value = volume ? grey_at(*volume, grey, in_volume.at(x, y)) : paper;
            const std::uint16_t own = at(x, y);
            const bool contour =
                at(x - 1, y) != own || at(x + 1, y) != own || at(x, y - 1) != own || at(x, y + 1) != own;
            const float tint = own == 0 ? 0.0F : contour ? 1.0F : volume ? 0.2F : 0.55F;
            const auto colour = own == 0 ? std::array<float, 3>{} : colour_of(*labels, own);
            for (std::size_t channel = 0; channel < 3; ++channel)
                picture.rgb[picture.offset(x, y) + channel] = static_cast<std::uint8_t>(
                    std::lround(255 * std::clamp((1 - tint) * value + tint * colour[channel], 0.0F, 1.0F)));
        }
    return picture;
}

std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> slice_outline(const SliceWindow& window,
                                                                       const TriangleMesh& surface) {
    std::vector<std::pair<Eigen::Vector2d, Eigen::Vector2d>> segments;
    const Eigen::Vector3d normal = window.normal();
    const auto seen = [&](const Eigen::Vector2d& pixel) {
        return pixel.minCoeff() >= 0 && pixel.maxCoeff() <= window.pixels;
    };
    for (const Triangle& triangle : surface.triangles) {
        std::array<Eigen::Vector2d, 2> ends;
        std::size_t found = 0;
        for (std::size_t i = 0; i < 3; ++i) {
            const Eigen::Vector3d& a = surface.vertices[triangle[i]];
            const Eigen::Vector3d& b = surface.vertices[triangle[(i + 1) % 3]];
            const double height_a = normal.dot(a - window.center), height_b = normal.dot(b - window.center);
            // A corner on the plane counts as above it, so exactly none or two edges cross.
            if ((height_a < 0) == (height_b < 0)) continue;
            ends[found++] = window.pixel_of(a + (b - a) * (height_a / (height_a - height_b)));
        }
        if (found == 2 && seen(ends[0]) && seen(ends[1])) segments.emplace_back(ends[0], ends[1]);
    }
    return segments;
}

}  // namespace palpate::report
