// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/surfaces/surfaces.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkFlyingEdges3D.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>

#include "formats/model/errors.hpp"
#include "tools/meshing/labels/region_labels.hpp"
#include "tools/meshing/labels/smoothed_labels.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/surfaces/pieces.hpp"

namespace palpate::meshing {
namespace {

TriangleMesh from_vtk(vtkPolyData* data) {
    TriangleMesh surface;
    surface.vertices.resize(data->GetNumberOfPoints());
    for (std::size_t v = 0; v < surface.vertices.size(); ++v)
        data->GetPoint(static_cast<vtkIdType>(v), surface.vertices[v].data());
    for (vtkIdType t = 0; t < data->GetNumberOfPolys(); ++t) {
        vtkIdType corners = 0;
        const vtkIdType* ids = nullptr;
        data->GetPolys()->GetCellAtId(t, corners, ids);
        surface.triangles.push_back({static_cast<std::int32_t>(ids[0]), static_cast<std::int32_t>(ids[1]),
                                     static_cast<std::int32_t>(ids[2])});
    }
    return surface;
}

// Keeps the triangles for which `keep` holds, and the vertices that they use, in their order.
template <typename Predicate>
TriangleMesh filter_triangles(const TriangleMesh& surface, Predicate&& keep) {
    TriangleMesh result;
    std::vector<std::int32_t> vertex_of(surface.vertices.size(), -1);
    for (const Triangle& t : surface.triangles)
        if (keep(t))
            for (const std::int32_t v : t) vertex_of[v] = 0;
    for (std::size_t v = 0; v < vertex_of.size(); ++v) {
        if (vertex_of[v] < 0) continue;
        vertex_of[v] = static_cast<std::int32_t>(result.vertices.size());
        result.vertices.push_back(surface.vertices[v]);
    }
    for (const Triangle& t : surface.triangles)
        if (keep(t)) result.triangles.push_back({vertex_of[t[0]], vertex_of[t[1]], vertex_of[t[2]]});
    if (result.triangles.empty())
        throw InvalidInput({"surface", "no piece is large enough", "", "keep smaller pieces"});
    return result;
}

}  // namespace

TriangleMesh isosurface(const Volume& volume, double isovalue) {
    const ImageGrid& grid = volume.grid;
    float lowest = std::numeric_limits<float>::max(), highest = std::numeric_limits<float>::lowest();
    for (const float value : volume.values) {
        lowest = std::min(lowest, value);
        highest = std::max(highest, value);
    }
    const auto level = static_cast<float>(isovalue);
    if (!(highest >= level))
        throw InvalidInput({"isovalue", fmt::format("{} is above every voxel", isovalue),
                            fmt::format("at most {}", highest), "choose a lower isovalue"});
    lowest = std::min(lowest, level - 1);
    const float margin = 1e-4F * (highest - lowest);

    // One voxel of padding on every side; the image's indices start at -1.
    vtkNew<vtkImageData> image;
    image->SetExtent(-1, grid.size[0], -1, grid.size[1], -1, grid.size[2]);
    image->AllocateScalars(VTK_FLOAT, 1);
    auto* padded = static_cast<float*>(image->GetScalarPointer());
    std::fill_n(padded, image->GetNumberOfPoints(), lowest);
    for (std::int32_t k = 0; k < grid.size[2]; ++k)
        for (std::int32_t j = 0; j < grid.size[1]; ++j) {
            const float* from = volume.values.data() + grid.offset(0, j, k);
            auto* to = static_cast<float*>(image->GetScalarPointer(0, j, k));
            for (std::int32_t i = 0; i < grid.size[0]; ++i) {
                if (from[i] >= level)
                    to[i] = std::max(from[i], level + margin);
                else if (!std::isnan(from[i]))
                    to[i] = std::min(from[i], level - margin);
            }
        }
    vtkNew<vtkFlyingEdges3D> contour;
    contour->SetInputData(image);
    contour->SetValue(0, isovalue);
    contour->ComputeNormalsOff();
    contour->ComputeGradientsOff();
    contour->ComputeScalarsOff();
    contour->Update();
    TriangleMesh surface = from_vtk(contour->GetOutput());
    for (Eigen::Vector3d& vertex : surface.vertices) vertex = grid.point_of(vertex);
    // The contour faces the low side or the high one depending on the handedness of the grid.
    if (measure(surface).volume < 0)
        for (Triangle& t : surface.triangles) std::swap(t[1], t[2]);
    return surface;
}

void keep_near_labels(Volume& volume, const LabelMap& map, std::span<const std::int32_t> values, int reach) {
    if (!same_grid(volume.grid, map.grid))
        throw InvalidInput({"label map", "does not lie on the volume's grid", "the same size and place",
                            "segment this volume, or resample the labels to it"});
    std::vector<std::uint8_t> near(map.labels.size());
    std::ranges::transform(map.labels, near.begin(), [&](std::uint16_t label) {
        return std::uint8_t{std::ranges::find(values, std::int32_t{label}) != values.end()};
    });
    const ImageGrid& grid = map.grid;
    const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(grid.size[0]), grid.offset(0, 0, 1)};
    for (int step = 0; step < reach; ++step) {
        const std::vector<std::uint8_t> before = near;
        std::size_t offset = 0;
        for (std::int32_t k = 0; k < grid.size[2]; ++k)
            for (std::int32_t j = 0; j < grid.size[1]; ++j)
                for (std::int32_t i = 0; i < grid.size[0]; ++i, ++offset) {
                    if (!before[offset]) continue;
                    const std::array<std::int32_t, 3> index{i, j, k};
                    for (std::size_t axis = 0; axis < 3; ++axis) {
                        if (index[axis] > 0) near[offset - stride[axis]] = 1;
                        if (index[axis] + 1 < grid.size[axis]) near[offset + stride[axis]] = 1;
                    }
                }
    }
    const float lowest = *std::ranges::min_element(volume.values);
    for (std::size_t v = 0; v < near.size(); ++v)
        if (!near[v]) volume.values[v] = lowest;
}

TriangleMesh region_surface(const SmoothedLabels& labels, std::uint8_t region, double volume) {
    const Volume leads = labels.leads(region);
    double level = 0, other_level = 0, other_excess = 0;
    TriangleMesh surface = isosurface(leads, level);
    constexpr double max_error = 1e-3;
    constexpr int max_rounds = 4;
    for (int round = 0; round < max_rounds; ++round) {
        const SurfaceQuality found = measure(surface);
        const double excess = found.volume - volume;
        if (std::abs(excess) < max_error * volume) break;
        // A lead falls by about one over a voxel; then the secant tells.
        const double slope = round == 0 ? -found.area * labels.grid().spacing.maxCoeff()
                                        : (excess - other_excess) / (level - other_level);
        other_level = level;
        other_excess = excess;
        constexpr double reach = 0.5;
        level = std::clamp(level - excess / slope, -reach, reach);
        if (!std::isfinite(level) || level == other_level) break;
        surface = isosurface(leads, level);
    }
    return surface;
}

TriangleMesh label_surface(const LabelMap& map, std::span<const std::int32_t> values, double smoothing) {
    const double sigma = smoothing < 0 ? map.grid.spacing.maxCoeff() : smoothing;
    RegionLabels labels = cut_out_regions(map, values, smoothing_margin(map.grid, sigma));
    labels.values.resize(1);
    for (std::uint8_t& region : labels.regions) region = region > 0 ? 1 : 0;
    const auto voxels = static_cast<double>(std::ranges::count(labels.regions, std::uint8_t{1}));
    return region_surface(SmoothedLabels(labels, sigma), 1, voxels * map.grid.voxel_volume());
}

TriangleMesh keep_large_pieces(const TriangleMesh& surface, std::int64_t min_triangles) {
    DisjointSets pieces = pieces_of(surface);
    std::vector<std::int64_t> triangles(surface.vertices.size(), 0);
    const auto piece = [&](const Triangle& t) { return pieces.root(static_cast<std::size_t>(t[0])); };
    for (const Triangle& t : surface.triangles) ++triangles[piece(t)];
    return filter_triangles(surface, [&](const Triangle& t) { return triangles[piece(t)] >= min_triangles; });
}

TriangleMesh keep_largest_piece(const TriangleMesh& surface) {
    DisjointSets pieces = pieces_of(surface);
    std::vector<double> areas(surface.vertices.size(), 0);
    const auto piece = [&](const Triangle& t) { return pieces.root(static_cast<std::size_t>(t[0])); };
    for (const Triangle& t : surface.triangles) {
        const auto point = [&](std::size_t c) -> const Eigen::Vector3d& { return surface.vertices[t[c]]; };
        areas[piece(t)] += (point(1) - point(0)).cross(point(2) - point(0)).norm();
    }
    const auto largest = static_cast<std::size_t>(std::ranges::max_element(areas) - areas.begin());
    return filter_triangles(surface, [&](const Triangle& t) { return piece(t) == largest; });
}

}  // namespace palpate::meshing
