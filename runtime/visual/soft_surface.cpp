// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/soft_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <map>
#include <vtkPointData.h>
#include <vtkProperty.h>

namespace palpate::visual {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Rgb warm(255, 214, 92);  // where the surface has moved far
const Rgb flesh(120, 44, 40);  // the inside, where a cut shows it

// Muted, as matter is: pure colours hide the shading.
Vector3f colour_of(const Label& label) {
    return 0.8F * 255 * Vector3f(label.colour[0], label.colour[1], label.colour[2]) + Vector3f(45, 40, 40);
}

// The region with most tetrahedra is the organ, the others are what it encloses.
std::int32_t main_region(const TetMesh& mesh) {
    std::map<std::int32_t, std::int64_t> counts;
    for (const std::int32_t region : mesh.regions) ++counts[region];
    return std::ranges::max_element(counts, {}, [](const auto& entry) { return entry.second; })->first;
}

// The organ's colour, tinted with an enclosed region's by how near to the surface that lies.
std::vector<Vector3f> hinted_colours(const DeformableBody& body) {
    constexpr float reach = 7;  // mm: depth at which the hint has faded to a third
    constexpr float strength = 0.75F;
    const TetMesh& mesh = body.mesh;
    const std::int32_t organ = main_region(mesh);
    std::map<std::int32_t, Vector3f> colours;
    for (const Label& label : mesh.region_names) colours[label.value] = colour_of(label);
    std::map<std::int32_t, std::int32_t> enclosed;  // node -> region
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (mesh.regions[t] != organ)
            for (const std::int32_t node : mesh.tetrahedra[t]) enclosed[node] = mesh.regions[t];

    std::vector<Vector3f> result;
    for (const Vector3d& vertex : body.boundary.surface.vertices) {
        float nearest = 1e30F;
        std::int32_t region = organ;
        for (const auto& [node, node_region] : enclosed) {
            const auto squared = static_cast<float>((mesh.rest_positions[node] - vertex).squaredNorm());
            if (squared < nearest) {
                nearest = squared;
                region = node_region;
            }
        }
        const float tint = strength * std::exp(-nearest / (reach * reach));
        result.push_back((1 - tint) * colours[organ] + tint * colours[region]);
    }
    return result;
}

}  // namespace

SoftSurface::SoftSurface(const DeformableBody& body, const Vector3d& toward_eye, vtkRenderer* renderer)
    : rest_colours_(hinted_colours(body)), triangles_(body.boundary.surface.triangles) {
    for (const Vector3d& p : body.boundary.surface.vertices) rest_.push_back(p.cast<float>());
    const auto data = poly_data(body.boundary.surface, toward_eye);
    points_ = data->GetPoints();
    normals_ = vtkFloatArray::SafeDownCast(data->GetPointData()->GetNormals());
    colours_ = vtkSmartPointer<vtkUnsignedCharArray>::New();
    colours_->SetNumberOfComponents(3);
    colours_->SetNumberOfTuples(static_cast<vtkIdType>(rest_.size()));
    data->GetPointData()->SetScalars(colours_);
    displaced_ = true;
    deform(std::vector<Vector3f>(rest_.size(), Vector3f::Zero()));

    actor_ = solid_actor(data, warm, flesh);
    actor_->GetProperty()->SetSpecular(0.25);
    actor_->GetProperty()->SetSpecularPower(30);
    renderer->AddActor(actor_);
}

void SoftSurface::deform(const std::vector<Vector3f>& displacements) {
    constexpr float warm_at = 6;  // mm of displacement
    const bool moves = std::ranges::any_of(displacements, [](const Vector3f& u) { return !u.isZero(0); });
    if (!moves && !displaced_) return;
    displaced_ = moves;
    // Three floats a point, as in VTK's arrays.
    static_assert(sizeof(Vector3f) == 3 * sizeof(float));
    const std::span points(static_cast<Vector3f*>(points_->GetVoidPointer(0)), rest_.size());
    std::uint8_t* colours = colours_->GetPointer(0);
    for (std::size_t i = 0; i < rest_.size(); ++i) {
        points[i] = rest_[i] + displacements[i];
        const float warmth = 0.8F * (1 - std::exp(-displacements[i].norm() / warm_at));
        const Vector3f colour = (1 - warmth) * rest_colours_[i] + warmth * warm;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<Eigen::Index>(axis);
            colours[3 * i + axis] = static_cast<std::uint8_t>(std::lround(colour[a]));
        }
    }
    vertex_normals(points, triangles_, {reinterpret_cast<Vector3f*>(normals_->GetPointer(0)), rest_.size()});
    points_->Modified();
    normals_->Modified();
    colours_->Modified();
}

}  // namespace palpate::visual
