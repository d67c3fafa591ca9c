// SPDX-License-Identifier: Apache-2.0
#include "sample_data/phantoms.hpp"

#include <algorithm>
#include <cmath>
#include <functional>
#include <random>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;

constexpr double field_of_view = 128;  // mm, each way

// What a point is made of; label 0 is not in the truth.
struct Tissue {
    double hu;
    std::int32_t label;
};

constexpr Tissue outside{-1000, 0}, soft_tissue{30, 0}, support{400, 0};

bool in_ellipsoid(const Vector3d& p, const Vector3d& center, const Vector3d& semi_axes) {
    return (p - center).cwiseQuotient(semi_axes).squaredNorm() <= 1;
}

// Of a cylinder along z.
bool in_cylinder(const Vector3d& p, double x, double y, double semi_x, double semi_y) {
    return std::pow((p[0] - x) / semi_x, 2) + std::pow((p[1] - y) / semi_y, 2) <= 1;
}

double distance_to_segment(const Vector3d& p, const Vector3d& a, const Vector3d& b) {
    const double along = std::clamp((p - a).dot(b - a) / (b - a).squaredNorm(), 0.0, 1.0);
    return (p - a - along * (b - a)).norm();
}

Tissue abdomen_at(const Vector3d& p) {
    constexpr Tissue liver{110, 1}, tumour{60, 2}, vessels{180, 3}, spine{600, 4}, ribs{700, 5};
    if (p[1] > 50 && p[1] < 53) return support;
    if (!in_cylinder(p, 0, 0, 56, 44)) return outside;
    if ((p - Vector3d(-22, -10, 4)).norm() <= 9) return tumour;
    const bool portal_vein = distance_to_segment(p, {-28, 4, -8}, {4, 8, -8}) <= 3;
    const bool aorta = in_cylinder(p, 6, 16, 5, 5);
    if (portal_vein || aorta) return vessels;
    if (in_cylinder(p, 0, 30, 10, 8)) return spine;
    // Rings of 3 mm radius along the body's wall; its curvature makes them slightly oval.
    const Vector3d on_wall = Vector3d(p[0], p[1], 0).normalized();
    const double radius = 1 / std::sqrt(std::pow(on_wall[0] / 50, 2) + std::pow(on_wall[1] / 38, 2));
    for (const double z : {-36.0, -12.0, 12.0, 36.0})
        if (std::hypot(std::hypot(p[0], p[1]) - radius, p[2] - z) <= 3) return ribs;
    return in_ellipsoid(p, {-14, -6, 0}, {30, 24, 26}) ? liver : soft_tissue;
}

Tissue head_at(const Vector3d& p) {
    constexpr Tissue skull{900, 1}, air{-1000, 2}, wall{40, 3};
    const Vector3d nasopharynx(0, -5, -40), nose(0, -40, -36);
    const bool in_head =
        in_ellipsoid(p, {0, 2, 12}, {48, 56, 46}) || (p[2] < 0 && in_cylinder(p, 0, -5, 38, 45));
    if (!in_head) return (p[1] > 60 && p[1] < 63) ? support : outside;
    const Vector3d skull_center(0, 4, 14);
    if (in_ellipsoid(p, skull_center, {43, 51, 41}))
        return in_ellipsoid(p, skull_center, {37, 45, 35}) ? soft_tissue : skull;
    const double distance = std::min({(p - nasopharynx).norm() - 11,                           //
                                      distance_to_segment(p, nasopharynx, {0, -5, -100}) - 6,  //
                                      distance_to_segment(p, nasopharynx, nose) - 5,           //
                                      distance_to_segment(p, nose, {0, -70, -36}) - 2.5});
    if (distance <= 0) return air;
    return distance <= 6 && (p - nasopharynx).norm() <= 20 ? wall : soft_tissue;
}

ImageGrid grid_of(const PhantomOptions& options) {
    ImageGrid grid;
    grid.spacing = options.spacing;
    grid.direction = options.direction;
    Vector3d last;
    for (int axis = 0; axis < 3; ++axis) {
        const auto voxels = static_cast<std::int32_t>(std::lround(field_of_view / options.spacing[axis]));
        grid.size[static_cast<std::size_t>(axis)] = std::max(voxels, 2);
        last[axis] = grid.size[static_cast<std::size_t>(axis)] - 1;
    }
    grid.origin = -(options.direction * options.spacing.asDiagonal() * last) / 2;
    return grid;
}

double mean_hu(const ImageGrid& grid, const Vector3d& index, int samples,
               Tissue (*tissue_at)(const Vector3d&)) {
    double sum = 0;
    for (int c = 0; c < samples; ++c)
        for (int b = 0; b < samples; ++b)
            for (int a = 0; a < samples; ++a) {
                const Vector3d inside = (Vector3d(a, b, c).array() + 0.5) / samples - 0.5;
                sum += tissue_at(grid.point_of(index + inside)).hu;
            }
    return sum / std::pow(samples, 3);
}

Phantom image(const PhantomOptions& options, Tissue (*tissue_at)(const Vector3d&),
              const std::vector<std::string>& names) {
    if (!(options.spacing.minCoeff() > 0) || options.samples_per_axis < 1 || !(options.noise_hu >= 0))
        throw InvalidInput({"phantom options", "spacing or samples not positive, or negative noise",
                            "positive spacing, 1 sample or more, noise of 0 or more", ""});
    Phantom phantom;
    const ImageGrid grid = phantom.volume.grid = phantom.truth.grid = grid_of(options);
    phantom.volume.values.reserve(grid.voxel_count());
    phantom.truth.labels.reserve(grid.voxel_count());
    std::mt19937_64 generator(options.seed);
    std::normal_distribution<double> noise(0, 1);
    for (std::int32_t k = 0; k < grid.size[2]; ++k)
        for (std::int32_t j = 0; j < grid.size[1]; ++j)
            for (std::int32_t i = 0; i < grid.size[0]; ++i) {
                const Vector3d index(i, j, k);
                const double hu = mean_hu(grid, index, options.samples_per_axis, tissue_at) +
                                  (options.noise_hu > 0 ? options.noise_hu * noise(generator) : 0);
                phantom.volume.values.push_back(static_cast<float>(std::round(std::max(hu, -1024.0))));
                phantom.truth.labels.push_back(
                    static_cast<std::uint16_t>(tissue_at(grid.point_of(index)).label));
            }
    for (const std::string& name : names) {
        const auto value = static_cast<std::int32_t>(phantom.truth.names.size() + 1);
        phantom.truth.names.push_back({value, name, default_label_colour(value)});
    }
    return phantom;
}

}  // namespace

Phantom abdomen_phantom(const PhantomOptions& options) {
    return image(options, abdomen_at, {"liver", "tumour", "vessels", "spine", "ribs"});
}

Phantom head_phantom(const PhantomOptions& options) {
    return image(options, head_at, {"skull", "airway", "wall"});
}

}  // namespace palpate
