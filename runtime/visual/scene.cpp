// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <map>
#include <vtkActor.h>
#include <vtkArrowSource.h>
#include <vtkCellArray.h>
#include <vtkCylinderSource.h>
#include <vtkFloatArray.h>
#include <vtkMatrix4x4.h>
#include <vtkPlane.h>
#include <vtkPlaneCollection.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderer.h>
#include <vtkSphereSource.h>
#include <vtkUnsignedCharArray.h>

#include "runtime/visual/display_copy.hpp"
#include "runtime/visual/vtk_mesh.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

const Vector3f bone(232, 219, 192);
const Vector3f warm(255, 214, 92);  // where the surface has moved far

vtkSmartPointer<vtkPolyDataMapper> mapper_of(vtkPolyData* data) {
    auto mapper = vtkSmartPointer<vtkPolyDataMapper>::New();
    mapper->SetInputData(data);
    return mapper;
}

void set_colour(vtkProperty* property, const Vector3f& colour) {
    property->SetColor(colour[0] / 255, colour[1] / 255, colour[2] / 255);
}

// Seen from inside, where a cut opened the body, a surface is flat in a darker colour: like solid matter.
void show_inside_as_solid(vtkActor* actor, const Vector3f& colour) {
    vtkNew<vtkProperty> inside;
    set_colour(inside, colour);
    inside->SetAmbient(1);
    inside->SetDiffuse(0);
    inside->SetSpecular(0);
    set_colour(actor->GetProperty(), colour);
    actor->SetBackfaceProperty(inside);
}

// Takes the unit x axis to `way`, scaled, at `origin`.
vtkSmartPointer<vtkMatrix4x4> placed_along(const Vector3d& origin, const Vector3d& way,
                                           const Vector3d& scale) {
    const Eigen::Matrix3d axes =
        Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), way).toRotationMatrix() * scale.asDiagonal();
    auto matrix = vtkSmartPointer<vtkMatrix4x4>::New();
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) matrix->SetElement(row, column, axes(row, column));
        matrix->SetElement(row, 3, origin[row]);
    }
    return matrix;
}

Vector3f colour_of(const Label& label) {
    return 255 * Vector3f(label.colour[0], label.colour[1], label.colour[2]);
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
            const auto squared = static_cast<float>(
                (mesh.rest_positions[static_cast<std::size_t>(node)] - vertex).squaredNorm());
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

SoftSurface::SoftSurface(const DeformableBody& body, vtkRenderer* renderer)
    : rest_colours_(hinted_colours(body)), triangles_(body.boundary.surface.triangles) {
    for (const Vector3d& p : body.boundary.surface.vertices) rest_.push_back(p.cast<float>());
    const auto data = poly_data(body.boundary.surface);
    points_ = data->GetPoints();
    const auto count = static_cast<vtkIdType>(rest_.size());
    normals_ = vtkSmartPointer<vtkFloatArray>::New();
    normals_->SetNumberOfComponents(3);
    normals_->SetNumberOfTuples(count);
    colours_ = vtkSmartPointer<vtkUnsignedCharArray>::New();
    colours_->SetNumberOfComponents(3);
    colours_->SetNumberOfTuples(count);
    data->GetPointData()->SetNormals(normals_);
    data->GetPointData()->SetScalars(colours_);
    displaced_ = true;
    deform(std::vector<Vector3f>(rest_.size(), Vector3f::Zero()));

    actor_ = vtkSmartPointer<vtkActor>::New();
    actor_->SetMapper(mapper_of(data));
    show_inside_as_solid(actor_, {120, 44, 40});
    actor_->GetProperty()->SetSpecular(0.35);
    actor_->GetProperty()->SetSpecularPower(30);
    renderer->AddActor(actor_);
}

void SoftSurface::deform(const std::vector<Vector3f>& displacements) {
    constexpr float full_warmth = 4;  // mm of displacement
    const bool moves = std::ranges::any_of(displacements, [](const Vector3f& u) { return !u.isZero(0); });
    if (!moves && !displaced_) return;
    displaced_ = moves;
    auto* points = static_cast<float*>(points_->GetVoidPointer(0));
    std::uint8_t* colours = colours_->GetPointer(0);
    for (std::size_t i = 0; i < rest_.size(); ++i) {
        const float warmth = 0.8F * std::min(1.0F, displacements[i].norm() / full_warmth);
        const Vector3f colour = (1 - warmth) * rest_colours_[i] + warmth * warm;
        for (std::size_t axis = 0; axis < 3; ++axis) {
            const auto a = static_cast<Eigen::Index>(axis);
            points[3 * i + axis] = rest_[i][a] + displacements[i][a];
            colours[3 * i + axis] = static_cast<std::uint8_t>(std::lround(colour[a]));
        }
    }
    compute_normals();
    points_->Modified();
    normals_->Modified();
    colours_->Modified();
}

void SoftSurface::compute_normals() {
    const Eigen::Map<const Eigen::Matrix3Xf> p(static_cast<const float*>(points_->GetVoidPointer(0)), 3,
                                               static_cast<Eigen::Index>(rest_.size()));
    Eigen::Map<Eigen::Matrix3Xf> n(normals_->GetPointer(0), 3, p.cols());
    n.setZero();
    for (const Triangle& t : triangles_) {
        const Vector3f area = (p.col(t[1]) - p.col(t[0])).cross(p.col(t[2]) - p.col(t[0]));
        for (const std::int32_t vertex : t) n.col(vertex) += area;
    }
    n.colwise().normalize();
}

Scene::Scene(const Case& patient_case, const Sight& sight, std::int64_t rigid_budget, vtkRenderer* renderer)
    : shaft_length_(0.35 * sight.field),
      arrow_length_(0.3 * sight.field),
      max_force_(patient_case.haptics.max_force) {
    std::size_t rigid_triangles = 0;
    for (const RigidBody& body : patient_case.rigid_bodies) rigid_triangles += body.surface.triangles.size();
    for (const RigidBody& body : patient_case.rigid_bodies) {
        const double share = static_cast<double>(body.surface.triangles.size()) /
                             static_cast<double>(std::max<std::size_t>(1, rigid_triangles));
        vtkNew<vtkPolyDataNormals> normals;
        normals->SetInputData(
            poly_data(display_copy(body.surface, std::llround(share * static_cast<double>(rigid_budget)))));
        normals->SplittingOff();
        normals->ConsistencyOff();
        normals->Update();
        auto actor = vtkSmartPointer<vtkActor>::New();
        actor->SetMapper(mapper_of(normals->GetOutput()));
        show_inside_as_solid(actor, 0.55F * bone);
        set_colour(actor->GetProperty(), bone);
        renderer->AddActor(actor);
        rigid_.push_back(actor);
    }
    for (const DeformableBody& body : patient_case.deformable_bodies) soft_.emplace_back(body, renderer);

    const double radius = patient_case.haptics.tool_radius;
    const auto ball = [&](vtkActor* actor, double r, const Vector3f& colour) {
        vtkNew<vtkSphereSource> sphere;
        sphere->SetRadius(r);
        sphere->SetThetaResolution(24);
        sphere->SetPhiResolution(16);
        sphere->Update();
        actor->SetMapper(mapper_of(sphere->GetOutput()));
        set_colour(actor->GetProperty(), colour);
        renderer->AddActor(actor);
    };
    ball(tool_, radius, {90, 170, 235});
    ball(device_, 0.6 * radius, {245, 245, 245});
    device_->GetProperty()->SetRepresentationToWireframe();

    // The stylus leans away from the line of sight, so that the tip is seen.
    const Vector3d side = sight.toward_eye.unitOrthogonal();
    shaft_way_ = (sight.toward_eye + 1.2 * side).normalized();
    vtkNew<vtkCylinderSource> cylinder;
    cylinder->SetRadius(0.45 * radius);
    cylinder->SetHeight(shaft_length_);
    cylinder->SetResolution(16);
    cylinder->Update();
    shaft_->SetMapper(mapper_of(cylinder->GetOutput()));
    set_colour(shaft_->GetProperty(), {170, 180, 190});
    shaft_->GetProperty()->SetSpecular(0.5);
    renderer->AddActor(shaft_);

    vtkNew<vtkArrowSource> arrow;
    arrow->SetShaftRadius(0.035);
    arrow->SetTipRadius(0.09);
    arrow->SetTipLength(0.28);
    arrow->SetShaftResolution(16);
    arrow->SetTipResolution(24);
    arrow->Update();
    arrow_->SetMapper(mapper_of(arrow->GetOutput()));
    arrow_->GetProperty()->SetAmbient(0.4);
    renderer->AddActor(arrow_);
}

void Scene::update(const VisualFrame& frame) {
    for (std::size_t i = 0; i < soft_.size(); ++i) soft_[i].deform(frame.displacements[i]);
    for (const auto& [actor, p] :
         {std::pair{tool_.Get(), frame.tool_position}, {device_.Get(), frame.device_position}})
        actor->SetPosition(p.x(), p.y(), p.z());
    // The cylinder's own axis is y: turn that onto x first.
    auto shaft =
        placed_along(frame.tool_position + shaft_way_ * shaft_length_ / 2, shaft_way_, Vector3d::Ones());
    vtkNew<vtkMatrix4x4> y_to_x;
    y_to_x->Zero();
    y_to_x->SetElement(0, 1, 1);
    y_to_x->SetElement(1, 0, -1);
    y_to_x->SetElement(2, 2, 1);
    y_to_x->SetElement(3, 3, 1);
    vtkMatrix4x4::Multiply4x4(shaft, y_to_x, shaft);
    shaft_->SetUserMatrix(shaft);

    constexpr double felt = 0.01;  // N
    const double newtons = frame.force.norm();
    arrow_->SetVisibility(newtons > felt);
    if (newtons <= felt) return;
    const double share = std::min(1.0, newtons / max_force_);
    // The root keeps small forces visible.
    const double length = arrow_length_ * std::sqrt(share);
    arrow_->SetUserMatrix(
        placed_along(frame.tool_position, frame.force / newtons, Vector3d::Constant(length)));
    const auto s = static_cast<float>(share);
    set_colour(arrow_->GetProperty(),
               s < 0.5F ? Vector3f(90 + 330 * s, 210, 90) : Vector3f(255, 420 - 420 * s, 60));
}

void Scene::cut_away(bool on, const Vector3d& point, const Vector3d& toward_eye) {
    cut_->SetOrigin(point.data());
    cut_->SetNormal(Vector3d(-toward_eye).data());
    const auto apply = [&](vtkActor* actor) {
        vtkAbstractMapper* mapper = actor->GetMapper();
        const bool has = mapper->GetClippingPlanes() && mapper->GetClippingPlanes()->GetNumberOfItems() > 0;
        if (on && !has) mapper->AddClippingPlane(cut_);
        if (!on && has) mapper->RemoveAllClippingPlanes();
    };
    for (const auto& actor : rigid_) apply(actor);
    for (const SoftSurface& surface : soft_) apply(surface.actor());
}

void Scene::show_rigid(bool on) {
    for (const auto& actor : rigid_) actor->SetVisibility(on);
}

}  // namespace palpate
