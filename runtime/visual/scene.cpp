// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numbers>
#include <vtkCellArray.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkProperty.h>

#include "runtime/visual/actors.hpp"
#include "runtime/visual/readings/force_colour.hpp"
#include "runtime/visual/tissue/tissue_colours.hpp"
#include "runtime/visual/tools/tool_shapes.hpp"

namespace palpate::visual {
namespace {

using Eigen::Vector3d;

const Rgb white(245, 245, 245);

// Of tissue: seen as grain in the first view, whatever its scale.
double grain_of(const Sight& sight) {
    return sight.field / 220;
}

// Away from the line of sight, so that the tip is seen; in a passage beside the eye, where there is room.
Vector3d shaft_way(const Sight& sight) {
    const Vector3d aside =
        sight.inside ? Vector3d(-0.2 * sight.axes().col(1)) : Vector3d(sight.toward_eye.unitOrthogonal());
    return (sight.toward_eye + aside).normalized();
}

// A coil along the x axis, 1 long and 1 wide.
vtkSmartPointer<vtkActor> coil(const Rgb& colour) {
    constexpr int turns = 7, steps = 14 * turns;
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> line;
    line->InsertNextCell(steps + 1);
    for (int i = 0; i <= steps; ++i) {
        const double share = static_cast<double>(i) / steps, angle = 2 * std::numbers::pi * turns * share;
        line->InsertCellPoint(points->InsertNextPoint(share, std::cos(angle) / 2, std::sin(angle) / 2));
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetLines(line);
    auto result = actor(data, colour);
    result->GetProperty()->LightingOff();
    result->GetProperty()->SetLineWidth(2);
    return result;
}

constexpr double handle_share = 0.35;  // of the field of view: how long a shaft is drawn

}  // namespace

Scene::Scene(const Case& patient_case, const Sight& sight, std::int64_t rigid_budget,
             std::optional<double> jaw_length, vtkRenderer* renderer, vtkRenderer* front)
    : tool_radius_(patient_case.haptics.tool_radius),
      max_force_((jaw_length ? 2 : 1) * patient_case.haptics.max_force),
      arrow_length_(0.5 * sight.field),
      shaft_length_(jaw_length     ? *jaw_length
                    : sight.inside ? 1.1 * (sight.eye() - sight.target).norm()
                                   : handle_share * sight.field),
      shaft_way_(shaft_way(sight)),
      others_({.radius = tool_radius_,
               .max_force = max_force_,
               .arrow_length = arrow_length_,
               .shaft_length = shaft_length_,
               .shaft_way = shaft_way_},
              renderer, front),
      stiffness_(patient_case, front) {
    // What is near and small comes first: software rendering then shades little that is covered later.
    add_tool(patient_case, sight, renderer, front);
    if (jaw_length) {
        handle_ = tool_shaft(tool_radius_, handle_share * sight.field, steel);
        renderer->AddActor(handle_);
    }
    for (const DeformableBody& body : patient_case.deformable_bodies)
        soft_.emplace_back(body, sight.toward_eye, grain_of(sight), stiffness_, renderer);
    add_rigid(patient_case, sight, rigid_budget, renderer);
    add_regions(patient_case, sight, front);
}

void Scene::add_rigid(const Case& patient_case, const Sight& sight, std::int64_t budget,
                      vtkRenderer* renderer) {
    double all = 0;
    for (const RigidBody& body : patient_case.rigid_bodies)
        all += static_cast<double>(body.surface.triangles.size());
    for (const RigidBody& body : patient_case.rigid_bodies) {
        const double share = static_cast<double>(body.surface.triangles.size()) / all;
        const auto own_budget = std::max(1LL, std::llround(share * static_cast<double>(budget)));
        rigid_.emplace_back(body, sight, own_budget, renderer);
    }
}

void Scene::add_regions(const Case& patient_case, const Sight& sight, vtkRenderer* front) {
    std::size_t count = 0;
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        regions_.emplace_back(body, sight.toward_eye, count, front);
        count += regions_.back().count();
    }
}

std::string Scene::region_names(std::optional<double> rendered) const {
    std::string names;
    for (const EnclosedRegions& regions : regions_)
        for (const std::string& name : regions.names(rendered)) names += (names.empty() ? "" : ", ") + name;
    return names;
}

void Scene::show_regions(bool on) {
    for (EnclosedRegions& regions : regions_) regions.show(on);
}

void Scene::show_stiffness(bool on) {
    for (SoftSurface& body : soft_) body.show_stiffness(on);
    if (on) stiffness_.fit();
    stiffness_.show(on);
}

void Scene::add_tool(const Case& patient_case, const Sight& sight, vtkRenderer* renderer,
                     vtkRenderer* front) {
    is_instrument_ = has_instrument(patient_case);
    tool_ = is_instrument_ ? actor(poly_data(patient_case.tool->surface, sight.toward_eye), steel)
                           : ball(tool_radius_, held_blue, 24);
    device_ = ball(0.6 * tool_radius_, white, 10);
    device_->GetProperty()->SetRepresentationToWireframe();

    shaft_ = tool_shaft(tool_radius_, shaft_length_, steel);
    arrow_ = force_arrow(1, white);
    arrow_->GetProperty()->SetAmbient(0.4);
    renderer->AddActor(tool_);
    if (!is_instrument_) renderer->AddActor(shaft_);
    spring_ = coil(white);
    for (const auto& part : {device_, arrow_, spring_}) front->AddActor(part);
}

void Scene::update(const VisualFrame& frame) {
    constexpr double spring_share = 0.05;  // of the tool's radius: a shorter spring is not seen
    for (std::size_t i = 0; i < soft_.size(); ++i) {
        soft_[i].deform(frame.displacements[i]);
        regions_[i].follow(frame.displacements[i]);
    }
    others_.update(frame.other_tools);
    place_tool(frame);
    place_along(device_, frame.device_position, Vector3d::UnitX(), 1);
    const bool stretched =
        tool_shown_ && (frame.device_position - frame.tool_position).norm() > spring_share * tool_radius_;
    spring_->SetVisibility(stretched);
    if (stretched) stretch_between(spring_, frame.tool_position, frame.device_position, 0.7 * tool_radius_);

    constexpr double felt = 0.01;  // N
    const double newtons = frame.force.norm();
    const bool pressed = tool_shown_ && newtons > felt;
    arrow_->SetVisibility(pressed);
    if (!pressed) return;
    const double share = std::min(1.0, newtons / max_force_);
    const Vector3d way = frame.force / newtons;
    // The root keeps small forces visible.
    place_along(arrow_, frame.tool_position + way * tool_radius_, way, arrow_length_ * std::sqrt(share));
    set_colour(arrow_, force_colour(share));
}

// A tool that turns by itself is drawn as it is turned.
void Scene::place_tool(const VisualFrame& frame) {
    const Vector3d known = shaft_of(frame), shaft = known.isZero() ? shaft_way_ : known;
    place_along(shaft_, frame.tool_position, shaft, 1);
    Eigen::Quaterniond held = Eigen::Quaterniond::Identity();  // a ball looks alike from everywhere
    if (turns(frame))
        held = frame.tool_orientation;
    else if (is_instrument_)
        held = Eigen::Quaterniond::FromTwoVectors(Vector3d::UnitZ(), shaft);
    place_turned(tool_, frame.tool_position, held);
    if (!handle_ || frame.other_tools.empty()) return;
    const OtherTool& other = frame.other_tools.front();
    const Vector3d hinge = (frame.tool_position + other.position + shaft_length_ * (shaft + other.shaft)) / 2;
    place_along(handle_, hinge, (shaft + other.shaft).normalized(), 1);
}

std::vector<vtkActor*> Scene::bodies() const {
    std::vector<vtkActor*> actors;
    for (const RigidSurface& body : rigid_) actors.push_back(body.actor());
    for (const SoftSurface& body : soft_) std::ranges::copy(body.actors(), std::back_inserter(actors));
    return actors;
}

void Scene::show_rigid(bool on) {
    for (RigidSurface& body : rigid_) body.show(on);
}

void Scene::show_tool(bool on) {
    tool_shown_ = on;
    for (const auto& part : {tool_, shaft_, device_}) part->SetVisibility(on);
    if (handle_) handle_->SetVisibility(on);
}

std::vector<vtkActor*> Scene::sections() const {
    std::vector<vtkActor*> actors;
    for (const RigidSurface& body : rigid_) actors.push_back(body.section());
    return actors;
}

std::vector<vtkActor*> Scene::opened() const {
    std::vector<vtkActor*> actors = sections();
    for (const SoftSurface& body : soft_) std::ranges::copy(body.actors(), std::back_inserter(actors));
    return actors;
}

void Scene::follow_cut(vtkRenderer* renderer, bool cut) {
    for (RigidSurface& body : rigid_) body.follow_cut(renderer, cut);
}

void Scene::show_inside(bool on) {
    for (SoftSurface& body : soft_) body.show_inside(on);
}

void Scene::draw(const Detail& detail) {
    for (RigidSurface& body : rigid_) body.show_fine(detail.fine_bodies);
    for (SoftSurface& body : soft_) body.show_grain(detail.grain);
}

}  // namespace palpate::visual
