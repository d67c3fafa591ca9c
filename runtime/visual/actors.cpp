// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/actors.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <vtkCellArray.h>
#include <vtkMatrix4x4.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyDataMapper.h>
#include <vtkProperty.h>

namespace palpate {
namespace {

void set_colour(vtkProperty* property, const Rgb& colour) {
    property->SetColor(colour[0] / 255, colour[1] / 255, colour[2] / 255);
}

}  // namespace

vtkSmartPointer<vtkPolyData> poly_data(const TriangleMesh& surface, const Eigen::Vector3d& toward_eye) {
    vtkNew<vtkPoints> points;
    points->SetNumberOfPoints(static_cast<vtkIdType>(surface.vertices.size()));
    for (std::size_t i = 0; i < surface.vertices.size(); ++i)
        points->SetPoint(static_cast<vtkIdType>(i), surface.vertices[i].data());
    std::vector<Triangle> triangles = surface.triangles;
    std::ranges::stable_sort(triangles, std::ranges::greater{}, [&](const Triangle& t) {
        double height = 0;
        for (const std::int32_t v : t)
            height += toward_eye.dot(surface.vertices[static_cast<std::size_t>(v)]);
        return height;
    });
    vtkNew<vtkCellArray> cells;
    const auto count = static_cast<vtkIdType>(triangles.size());
    cells->AllocateExact(count, 3 * count);
    for (const Triangle& t : triangles) cells->InsertNextCell({t[0], t[1], t[2]});
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points);
    data->SetPolys(cells);
    return data;
}

vtkSmartPointer<vtkActor> actor(vtkPolyData* data, const Rgb& colour) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    auto result = vtkSmartPointer<vtkActor>::New();
    result->SetMapper(mapper);
    set_colour(result, colour);
    result->GetProperty()->SetAmbient(0.13);
    return result;
}

vtkSmartPointer<vtkActor> solid_actor(vtkPolyData* data, const Rgb& colour, const Rgb& inside) {
    auto result = actor(data, colour);
    vtkNew<vtkProperty> back;
    set_colour(back, inside);
    back->SetAmbient(1);
    back->SetDiffuse(0);
    result->SetBackfaceProperty(back);
    return result;
}

void set_colour(vtkActor* actor, const Rgb& colour) {
    set_colour(actor->GetProperty(), colour);
}

void place_along(vtkActor* actor, const Eigen::Vector3d& origin, const Eigen::Vector3d& way, double scale) {
    const Eigen::Matrix3d axes =
        scale * Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitX(), way).toRotationMatrix();
    vtkNew<vtkMatrix4x4> matrix;
    for (int row = 0; row < 3; ++row) {
        for (int column = 0; column < 3; ++column) matrix->SetElement(row, column, axes(row, column));
        matrix->SetElement(row, 3, origin[row]);
    }
    actor->SetUserMatrix(matrix);
}

}  // namespace palpate
