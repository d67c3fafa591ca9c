// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/measures/surface_distance.hpp"

#include <algorithm>
#include <cmath>
#include <future>
#include <vtkCellArray.h>
#include <vtkGenericCell.h>
#include <vtkNew.h>
#include <vtkPolyData.h>
#include <vtkStaticCellLocator.h>

namespace palpate::meshing {
namespace {

std::vector<double> largest_of_triangles(const TriangleMesh& surface, std::span<const SurfaceSample> samples,
                                         std::span<const NearestPlace> places) {
    std::vector<double> of_vertex(surface.vertices.size(), 0), of_triangle(surface.triangles.size(), 0);
    for (std::size_t i = 0; i < samples.size(); ++i) {
        double& most = of_triangle[samples[i].triangle];
        most = std::max(most, places[i].distance);
        if (samples[i].vertex >= 0) of_vertex[samples[i].vertex] = places[i].distance;
    }
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (const std::int32_t v : surface.triangles[t])
            of_triangle[t] = std::max(of_triangle[t], of_vertex[v]);
    return of_triangle;
}

vtkNew<vtkPolyData> to_vtk(const TriangleMesh& surface) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    points->SetNumberOfPoints(static_cast<vtkIdType>(surface.vertices.size()));
    for (std::size_t v = 0; v < surface.vertices.size(); ++v)
        points->SetPoint(static_cast<vtkIdType>(v), surface.vertices[v].data());
    vtkNew<vtkCellArray> triangles;
    triangles->AllocateExact(static_cast<vtkIdType>(surface.triangles.size()),
                             3 * static_cast<vtkIdType>(surface.triangles.size()));
    for (const Triangle& t : surface.triangles) triangles->InsertNextCell({t[0], t[1], t[2]});
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetPolys(triangles);
    return data;
}

}  // namespace

std::vector<SurfaceSample> samples_of(const TriangleMesh& surface) {
    std::vector<SurfaceSample> samples;
    std::vector<bool> seen(surface.vertices.size(), false);
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto triangle = static_cast<std::int32_t>(t);
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (std::size_t c = 0; c < 3; ++c) {
            const std::int32_t vertex = surface.triangles[t][c], next = surface.triangles[t][(c + 1) % 3];
            const Eigen::Vector3d& p = surface.vertices[vertex];
            sum += p;
            if (!seen[vertex]) samples.push_back({p, triangle, vertex});
            seen[vertex] = true;
            // The triangle on the other side runs along the edge the other way.
            if (vertex < next) samples.push_back({(p + surface.vertices[next]) / 2, triangle});
        }
        samples.push_back({sum / 3, triangle});
    }
    return samples;
}

std::vector<NearestPlace> nearest_places(std::span<const SurfaceSample> samples,
                                         const TriangleMesh& surface) {
    const vtkNew<vtkPolyData> target = to_vtk(surface);
    vtkNew<vtkStaticCellLocator> locator;
    locator->SetDataSet(target);
    locator->BuildLocator();
    std::vector<NearestPlace> places(samples.size());
    const auto search = [&](std::size_t begin, std::size_t end) {
        vtkNew<vtkGenericCell> cell;
        for (std::size_t i = begin; i < end; ++i) {
            Eigen::Vector3d closest;
            vtkIdType triangle = 0;
            int sub_id = 0;
            double squared_distance = 0;
            locator->FindClosestPoint(samples[i].point.data(), closest.data(), cell, triangle, sub_id,
                                      squared_distance);
            places[i] = {std::sqrt(squared_distance), static_cast<std::int32_t>(triangle)};
        }
    };
    // Each place is found on its own: two threads find the same.
    auto second_half = std::async(std::launch::async, search, samples.size() / 2, samples.size());
    search(0, samples.size() / 2);
    second_half.get();
    return places;
}

SurfaceDistance summary(std::span<const SurfaceSample> samples_a, std::span<const NearestPlace> of_a,
                        std::span<const SurfaceSample> samples_b, std::span<const NearestPlace> of_b) {
    std::vector<double> distances;
    SurfaceDistance result;
    for (const auto& [samples, places] : {std::pair(samples_a, of_a), std::pair(samples_b, of_b)})
        for (std::size_t i = 0; i < places.size(); ++i) {
            distances.push_back(places[i].distance);
            if (!(places[i].distance > result.maximum)) continue;
            result.maximum = places[i].distance;
            result.farthest = samples[i].point;
        }
    std::ranges::sort(distances);
    for (const double distance : distances) result.mean += distance / static_cast<double>(distances.size());
    result.percentile_95 =
        distances[static_cast<std::size_t>(0.95 * static_cast<double>(distances.size() - 1))];
    return result;
}

TriangleDistances triangle_distances(const TriangleMesh& surface, const TriangleMesh& reference) {
    if (surface.vertices == reference.vertices && surface.triangles == reference.triangles)
        return {{}, std::vector<double>(surface.triangles.size(), 0)};
    const std::vector<SurfaceSample> samples = samples_of(surface), of_reference = samples_of(reference);
    const std::vector<NearestPlace> places = nearest_places(samples, reference);
    return {summary(samples, places, of_reference, nearest_places(of_reference, surface)),
            largest_of_triangles(surface, samples, places)};
}

SurfaceDistance surface_distance(const TriangleMesh& a, const TriangleMesh& b) {
    return triangle_distances(a, b).whole;
}

}  // namespace palpate::meshing
