// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/lesson/lesson_scene.hpp"

#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>
#include <vtkRegularPolygonSource.h>
#include <vtkSphereSource.h>
#include <vtkTubeFilter.h>

#include "runtime/visual/actors.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

// Told apart by lightness too, for eyes that do not tell colours apart.
const Rgb due_colour(255, 214, 64), waiting_colour(120, 150, 200), done_colour(90, 95, 100),
    truth_colour(240, 90, 200), line_colour(255, 214, 64), path_colour(150, 220, 255);
constexpr double path_radius = 0.25;  // mm

Rgb colour_of(LessonMark::State state) {
    switch (state) {
        case LessonMark::State::due:
            return due_colour;
        case LessonMark::State::waiting:
            return waiting_colour;
        case LessonMark::State::done:
            return done_colour;
        case LessonMark::State::truth:
            break;
    }
    return truth_colour;
}

vtkSmartPointer<vtkActor> glowing(vtkPolyData* data, const Rgb& colour) {
    auto result = actor(data, colour);
    result->GetProperty()->SetAmbient(0.7);
    result->GetProperty()->SetDiffuse(0.5);
    return result;
}

vtkSmartPointer<vtkActor> tube_along(const std::vector<Vector3d>& points, double radius, const Rgb& colour) {
    vtkNew<vtkPoints> places;
    vtkNew<vtkCellArray> cells;
    cells->InsertNextCell(static_cast<int>(points.size()));
    for (const Vector3d& p : points) cells->InsertCellPoint(places->InsertNextPoint(p.data()));
    vtkNew<vtkPolyData> data;
    data->SetPoints(places);
    data->SetLines(cells);
    vtkNew<vtkTubeFilter> tube;
    tube->SetInputData(data);
    tube->SetRadius(radius);
    tube->SetNumberOfSides(8);
    tube->Update();
    return glowing(tube->GetOutput(), colour);
}

vtkSmartPointer<vtkActor> actor_of(const LessonMark& mark) {
    if (mark.axis.isZero()) {
        vtkNew<vtkSphereSource> ball;
        ball->SetRadius(mark.radius);
        ball->SetCenter(mark.place[0], mark.place[1], mark.place[2]);
        ball->SetThetaResolution(20);
        ball->SetPhiResolution(14);
        ball->Update();
        return glowing(ball->GetOutput(), colour_of(mark.state));
    }
    vtkNew<vtkRegularPolygonSource> ring;
    ring->SetRadius(mark.radius);
    ring->SetCenter(mark.place[0], mark.place[1], mark.place[2]);
    ring->SetNormal(mark.axis[0], mark.axis[1], mark.axis[2]);
    ring->SetNumberOfSides(36);
    ring->GeneratePolygonOff();
    vtkNew<vtkTubeFilter> tube;
    tube->SetInputConnection(ring->GetOutputPort());
    tube->SetRadius(0.08 * mark.radius);
    tube->SetNumberOfSides(8);
    tube->Update();
    return glowing(tube->GetOutput(), colour_of(mark.state));
}

}  // namespace

void LessonScene::update(const LessonView& view) {
    if (view.marks != marks_) {
        for (const auto& mark : mark_actors_) renderer_->RemoveActor(mark);
        mark_actors_.clear();
        marks_ = view.marks;
        for (const LessonMark& mark : marks_) {
            mark_actors_.push_back(actor_of(mark));
            renderer_->AddActor(mark_actors_.back());
        }
    }
    const auto follow = [&](const std::vector<Vector3d>& points, std::vector<Vector3d>& shown,
                            vtkSmartPointer<vtkActor>& tube, double radius, const Rgb& colour) {
        if (points == shown) return;
        if (tube) renderer_->RemoveActor(tube);
        tube = points.size() > 1 ? tube_along(points, radius, colour) : nullptr;
        if (tube) renderer_->AddActor(tube);
        shown = points;
    };
    follow(view.line, line_, line_actor_, view.line_radius, line_colour);
    follow(view.line_done, line_done_, done_actor_, 1.2 * view.line_radius, done_colour);
    follow(view.path, path_, path_actor_, path_radius, path_colour);
    std::vector<Vector3d> outline = view.outline;
    if (!outline.empty()) outline.push_back(outline.front());
    follow(outline, outline_, outline_actor_, view.line_radius, truth_colour);
}

}  // namespace palpate::visual
