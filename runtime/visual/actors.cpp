// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/actors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <vtkCellArray.h>
#include <vtkFloatArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>
#include <vtkShaderProperty.h>

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

// VTK's shaders discard what is wholly transparent, and none of this is. Without that a rasteriser need not
// wait for the shader before it writes depth: up to a tenth of a frame's time in software, less where little
// is hidden.
constexpr auto discard_transparent =
    "  if (gl_FragData[0].a <= 0.0)\n"
    "    {\n"
    "    discard;\n"
    "    }\n";

void paint(vtkProperty* property, const Rgb& colour) {
    property->SetColor(colour[0] / 255, colour[1] / 255, colour[2] / 255);
}

Eigen::Matrix3d turned_to(const Vector3d& way) {
    return Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitX(), way).toRotationMatrix();
}

void place(vtkActor* actor, const Vector3d& origin, const Eigen::Matrix3d& axes) {
    vtkNew<vtkMatrix4x4> matrix;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) matrix->SetElement(row, column, axes(row, column));
        matrix->SetElement(row, 3, origin[row]);
    }
    actor->SetUserMatrix(matrix);
}

}  // namespace

void place_turned(vtkActor* actor, const Vector3d& origin, const Eigen::Quaterniond& orientation) {
    place(actor, origin, orientation.toRotationMatrix());
}

void vertex_normals(std::span<const Eigen::Vector3f> positions, std::span<const Triangle> triangles,
                    std::span<Eigen::Vector3f> normals) {
    std::ranges::fill(normals, Eigen::Vector3f::Zero());
    const auto p = [&](std::int32_t vertex) { return positions[vertex]; };
    for (const Triangle& t : triangles) {
        const Eigen::Vector3f area = (p(t[1]) - p(t[0])).cross(p(t[2]) - p(t[0]));
        for (const std::int32_t vertex : t) normals[vertex] += area;
    }
    for (Eigen::Vector3f& normal : normals) normal.normalize();
}

vtkSmartPointer<vtkPolyData> poly_data(const TriangleMesh& surface, const Vector3d& toward_eye) {
    std::vector<Eigen::Vector3f> positions;
    for (const Vector3d& p : surface.vertices) positions.push_back(p.cast<float>());
    std::vector<Eigen::Vector3f> normals(positions.size());
    vertex_normals(positions, surface.triangles, normals);

    const auto point_count = static_cast<vtkIdType>(positions.size());
    vtkNew<vtkPoints> points;
    points->SetNumberOfPoints(point_count);
    vtkNew<vtkFloatArray> point_normals;
    point_normals->SetNumberOfComponents(3);
    point_normals->SetNumberOfTuples(point_count);
    for (vtkIdType i = 0; i < point_count; ++i) {
        points->SetPoint(i, positions[i].data());
        point_normals->SetTypedTuple(i, normals[i].data());
    }

    std::vector<Triangle> triangles = surface.triangles;
    std::ranges::stable_sort(triangles, std::ranges::greater{}, [&](const Triangle& t) {
        double height = 0;
        for (const std::int32_t v : t) height += toward_eye.dot(surface.vertices[v]);
        return height;
    });
    vtkNew<vtkCellArray> cells;
    const auto count = static_cast<vtkIdType>(triangles.size());
    cells->AllocateExact(count, 3 * count);
    for (const Triangle& t : triangles) cells->InsertNextCell({t[0], t[1], t[2]});

    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(cells);
    data->GetPointData()->SetNormals(point_normals);
    return data;
}

vtkSmartPointer<vtkActor> actor(vtkPolyData* data, const Rgb& colour) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    auto result = vtkSmartPointer<vtkActor>::New();
    result->SetMapper(mapper);
    set_colour(result, colour);
    result->GetShaderProperty()->AddFragmentShaderReplacement(discard_transparent, true, "", false);
    result->GetProperty()->SetAmbient(0.13);
    return result;
}

void set_colour(vtkActor* actor, const Rgb& colour) {
    paint(actor->GetProperty(), colour);
}

void place_along(vtkActor* actor, const Eigen::Vector3d& origin, const Eigen::Vector3d& way, double scale) {
    place(actor, origin, turned_to(way) * scale);
}

void stretch_between(vtkActor* actor, const Eigen::Vector3d& a, const Eigen::Vector3d& b, double width) {
    const double length = (b - a).norm();
    place(actor, a, turned_to((b - a) / length) * Vector3d(length, width, width).asDiagonal());
}

}  // namespace palpate::visual
