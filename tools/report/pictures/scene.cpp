// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/pictures/scene.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <map>
#include <span>
#include <vtkActor.h>
#include <vtkActorCollection.h>
#include <vtkCamera.h>
#include <vtkCellArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkPolyDataMapper.h>
#include <vtkPolyDataNormals.h>
#include <vtkProperty.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>
#include <vtkWindowToImageFilter.h>

#include "tools/meshing/measures/tet_faces.hpp"

namespace palpate::report {
namespace {

using Colour = std::array<float, 3>;
constexpr Colour bone{0.90F, 0.85F, 0.74F};
constexpr Colour untouchable{0.62F, 0.66F, 0.70F};
constexpr Colour fixed_dot{0.10F, 0.16F, 0.26F};

vtkSmartPointer<vtkPoints> points_of(const std::vector<Eigen::Vector3d>& positions) {
    auto points = vtkSmartPointer<vtkPoints>::New();
    points->SetNumberOfPoints(static_cast<vtkIdType>(positions.size()));
    for (std::size_t i = 0; i < positions.size(); ++i)
        points->SetPoint(static_cast<vtkIdType>(i), positions[i].data());
    return points;
}

vtkSmartPointer<vtkPolyData> poly_data(const std::vector<Eigen::Vector3d>& positions,
                                       const std::vector<Triangle>& triangles) {
    auto data = vtkSmartPointer<vtkPolyData>::New();
    data->SetPoints(points_of(positions));
    vtkNew<vtkCellArray> cells;
    for (const Triangle& t : triangles) {
        const std::array<vtkIdType, 3> corners{t[0], t[1], t[2]};
        cells->InsertNextCell(3, corners.data());
    }
    data->SetPolys(cells);
    return data;
}

vtkSmartPointer<vtkActor> actor_of(vtkPolyData* data, const Colour& colour, double opacity) {
    vtkNew<vtkPolyDataMapper> mapper;
    mapper->SetInputData(data);
    mapper->ScalarVisibilityOff();
    auto actor = vtkSmartPointer<vtkActor>::New();
    actor->SetMapper(mapper);
    vtkProperty* property = actor->GetProperty();
    property->SetColor(colour[0], colour[1], colour[2]);
    property->SetOpacity(opacity);
    property->SetSpecular(0.12);
    property->SetSpecularPower(20);
    property->SetAmbient(0.12);
    property->SetDiffuse(0.88);
    return actor;
}

vtkSmartPointer<vtkActor> surface_actor(const std::vector<Eigen::Vector3d>& positions,
                                        const std::vector<Triangle>& triangles, const Colour& colour,
                                        double opacity) {
    vtkNew<vtkPolyDataNormals> normals;
    normals->SetInputData(poly_data(positions, triangles));
    normals->SplittingOff();
    normals->ConsistencyOff();
    normals->Update();
    return actor_of(normals->GetOutput(), colour, opacity);
}

vtkSmartPointer<vtkActor> dots(const TetMesh& mesh, const std::vector<std::int32_t>& nodes) {
    vtkNew<vtkPoints> points;
    vtkNew<vtkCellArray> vertices;
    for (const std::int32_t node : nodes) {
        const vtkIdType id = points->InsertNextPoint(mesh.rest_positions[node].data());
        vertices->InsertNextCell(1, &id);
    }
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    data->SetVerts(vertices);
    auto actor = actor_of(data, fixed_dot, 1);
    actor->GetProperty()->SetPointSize(6);
    actor->GetProperty()->SetRenderPointsAsSpheres(true);
    return actor;
}

TriangleMesh region_surface(const TetMesh& mesh, std::int32_t region) {
    TetMesh part;
    part.rest_positions = mesh.rest_positions;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (mesh.regions[t] == region) part.tetrahedra.push_back(mesh.tetrahedra[t]);
    return boundary_surface(part).surface;
}

// The outer region's surface is glass, what it encloses is solid.
void add_regions(vtkRenderer* renderer, const DeformableBody& body, double outer_opacity) {
    std::vector<std::pair<std::size_t, Label>> by_size;
    for (const Label& label : body.mesh.region_names)
        by_size.emplace_back(std::ranges::count(body.mesh.regions, label.value), label);
    std::ranges::stable_sort(by_size, std::ranges::greater{}, &std::pair<std::size_t, Label>::first);
    for (std::size_t i = 1; i < by_size.size(); ++i) {
        const TriangleMesh inner = region_surface(body.mesh, by_size[i].second.value);
        renderer->AddActor(surface_actor(inner.vertices, inner.triangles, by_size[i].second.colour, 1));
    }

    std::vector<Triangle> touchable, other;
    for (const Triangle& t : body.boundary.surface.triangles) {
        const bool contact = std::ranges::all_of(t, [&](std::int32_t vertex) {
            return std::ranges::binary_search(body.contact_nodes, body.boundary.nodes[vertex]);
        });
        (contact ? touchable : other).push_back(t);
    }
    const Colour colour = by_size.empty() ? bone : by_size.front().second.colour;
    const double opacity = by_size.size() > 1 ? outer_opacity : 1;
    const auto& positions = body.boundary.surface.vertices;
    renderer->AddActor(surface_actor(positions, touchable, colour, opacity));
    renderer->AddActor(surface_actor(positions, other, untouchable, opacity));
}

// The tetrahedra behind the middle of the mesh, whole ones.
TetMesh back_half(const TetMesh& mesh, const ViewDirection& direction) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& p : mesh.rest_positions) box.extend(p);
    TetMesh half;
    half.rest_positions = mesh.rest_positions;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const std::int32_t node : mesh.tetrahedra[t]) sum += mesh.rest_positions[node];
        if ((sum / 4 - box.center()).dot(direction) > 0) continue;
        half.tetrahedra.push_back(mesh.tetrahedra[t]);
        half.regions.push_back(mesh.regions[t]);
    }
    return half;
}

constexpr int width = 760, height = 620;  // pixels of a picture
constexpr int samples = 2;                // each way in a pixel: smooth edges, also of glassy layers

// Narrows the view until everything just fits; some two thousand points of each surface tell.
void fit(vtkRenderer* renderer) {
    constexpr double filled = 0.95;  // of the picture, at the tightest
    renderer->GetActiveCamera()->SetWindowCenter(0, 0);
    renderer->ResetCamera();
    Eigen::AlignedBox2d seen;
    vtkActorCollection* actors = renderer->GetActors();
    actors->InitTraversal();
    while (vtkActor* actor = actors->GetNextActor()) {
        vtkPoints* points = vtkPolyData::SafeDownCast(actor->GetMapper()->GetInput())->GetPoints();
        const vtkIdType step = points->GetNumberOfPoints() / 2000 + 1;
        for (vtkIdType i = 0; i < points->GetNumberOfPoints(); i += step) {
            std::array<double, 3> p{};
            points->GetPoint(i, p.data());
            renderer->WorldToView(p[0], p[1], p[2]);
            seen.extend(Eigen::Vector2d(p[0], p[1]));
        }
    }
    if (seen.isEmpty()) return;
    const double zoom = 2 * filled / seen.sizes().maxCoeff();
    const Eigen::Vector2d middle = zoom * seen.center();
    renderer->GetActiveCamera()->Zoom(zoom);
    renderer->GetActiveCamera()->SetWindowCenter(middle.x(), middle.y());
}

Picture grabbed(vtkRenderWindow* window) {
    vtkNew<vtkWindowToImageFilter> grab;
    grab->SetInput(window);
    grab->SetInputBufferTypeToRGB();
    grab->ReadFrontBufferOff();
    grab->ShouldRerenderOff();  // it is drawn
    grab->Update();
    vtkImageData* image = grab->GetOutput();
    Picture picture{width, height, {}};
    picture.rgb.resize(picture.offset(0, height));
    // Three bytes a pixel, rows from below.
    const std::span pixels(static_cast<const std::uint8_t*>(image->GetScalarPointer()),
                           samples * samples * picture.rgb.size());
    const auto sampled = [&](int x, int y, std::size_t channel) {
        const auto row = static_cast<std::size_t>(samples * height - 1 - y);
        return pixels[3 * (row * samples * width + static_cast<std::size_t>(x)) + channel];
    };
    for (int y = 0; y < height; ++y)
        for (int x = 0; x < width; ++x)
            for (std::size_t channel = 0; channel < 3; ++channel) {
                int sum = 0;
                for (int sample = 0; sample < samples * samples; ++sample)
                    sum += sampled(samples * x + sample % samples, samples * y + sample / samples, channel);
                picture.rgb[picture.offset(x, y) + channel] =
                    static_cast<std::uint8_t>(sum / (samples * samples));
            }
    return picture;
}

Eigen::Vector2d seen_at(vtkRenderer* renderer, const Eigen::Vector3d& p_P) {
    double x = p_P.x(), y = p_P.y(), z = p_P.z();
    renderer->WorldToView(x, y, z);
    return {(x + 1) / 2 * width, (1 - y) / 2 * height};
}

std::vector<SceneView> draw(const PictureWindow& window, vtkRenderer* renderer,
                            const std::vector<ViewDirection>& directions,
                            const std::vector<Eigen::Vector3d>& marked = {}, bool parallel = false) {
    window.get()->AddRenderer(renderer);
    renderer->SetBackground(0.965, 0.972, 0.98);
    std::vector<SceneView> views;
    for (const ViewDirection& from : directions) {
        vtkCamera* camera = renderer->GetActiveCamera();
        camera->SetViewAngle(20);
        camera->SetFocalPoint(0, 0, 0);
        camera->SetPosition(from.x(), from.y(), from.z());
        camera->SetViewUp(0, 0, 1);
        camera->SetParallelProjection(parallel);
        fit(renderer);
        window.get()->Render();
        SceneView view{grabbed(window.get()), {}, parallel ? 2 * camera->GetParallelScale() / height : 0};
        for (const Eigen::Vector3d& p : marked) view.marks.push_back(seen_at(renderer, p));
        views.push_back(std::move(view));
    }
    window.get()->RemoveRenderer(renderer);
    return views;
}

}  // namespace

PictureWindow::PictureWindow() {
    window_->SetOffScreenRendering(1);
    window_->SetMultiSamples(0);
    window_->SetSize(samples * width, samples * height);
}

std::vector<SceneView> scene_pictures(const PictureWindow& window, const Case& patient_case,
                                      const std::vector<ViewDirection>& directions) {
    vtkNew<vtkRenderer> renderer;
    for (const DeformableBody& body : patient_case.deformable_bodies) add_regions(renderer, body, 0.55);
    const double opacity = patient_case.deformable_bodies.empty() ? 1 : 0.25;
    for (const RigidBody& body : patient_case.rigid_bodies)
        renderer->AddActor(surface_actor(body.surface.vertices, body.surface.triangles, bone, opacity));
    return draw(window, renderer, directions);
}

std::vector<SceneView> body_pictures(const PictureWindow& window, const DeformableBody& body,
                                     const std::vector<ViewDirection>& directions) {
    vtkNew<vtkRenderer> renderer;
    add_regions(renderer, body, 0.45);
    renderer->AddActor(dots(body.mesh, body.fixed_nodes));
    return draw(window, renderer, directions);
}

std::vector<SceneView> tetrahedra_pictures(const PictureWindow& window, const DeformableBody& body,
                                           const std::vector<std::size_t>& tetrahedra,
                                           const std::vector<ViewDirection>& directions) {
    constexpr Colour red{0.75F, 0.10F, 0.08F};
    TetMesh part;
    part.rest_positions = body.mesh.rest_positions;
    std::vector<Eigen::Vector3d> centroids;
    for (const std::size_t t : tetrahedra) {
        part.tetrahedra.push_back(body.mesh.tetrahedra[t]);
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (const std::int32_t node : part.tetrahedra.back()) sum += part.rest_positions[node];
        centroids.push_back(sum / 4);
    }
    const TriangleMesh solid = boundary_surface(part).surface;
    vtkNew<vtkRenderer> renderer;
    renderer->AddActor(
        surface_actor(body.boundary.surface.vertices, body.boundary.surface.triangles, untouchable, 0.3));
    renderer->AddActor(actor_of(poly_data(solid.vertices, solid.triangles), red, 1));
    return draw(window, renderer, directions, centroids);
}

std::vector<SceneView> mesh_pictures(const PictureWindow& window, const TetMesh& mesh,
                                     const std::vector<ViewDirection>& directions, bool cut) {
    std::vector<SceneView> views;
    for (const ViewDirection& direction : directions) {
        const TetMesh shown = cut ? back_half(mesh, direction) : mesh;
        std::map<std::int32_t, std::vector<Triangle>> faces;
        for (const meshing::InterfaceFace& face : meshing::interface_faces(shown))
            if (face.outer == 0) faces[face.inner].push_back(face.nodes);
        vtkNew<vtkRenderer> renderer;
        for (const auto& [region, triangles] : faces) {
            const auto label = std::ranges::find(mesh.region_names, region, &Label::value);
            const auto actor =
                actor_of(poly_data(mesh.rest_positions, triangles),
                         label != mesh.region_names.end() ? label->colour : default_label_colour(region), 1);
            vtkProperty* property = actor->GetProperty();
            property->SetInterpolationToFlat();
            property->SetSpecular(0);
            property->SetAmbient(0.45);
            property->SetDiffuse(0.55);
            property->EdgeVisibilityOn();
            property->SetEdgeColor(0.12, 0.12, 0.14);
            property->SetLineWidth(1);
            renderer->AddActor(actor);
        }
        views.push_back(draw(window, renderer, {direction}, {}, true).front());
    }
    return views;
}

std::vector<SceneView> coloured_pictures(const PictureWindow& window, const TriangleMesh& surface,
                                         const std::vector<double>& triangle_values, const ColourScale& scale,
                                         const Eigen::Vector3d& marked,
                                         const std::vector<ViewDirection>& directions) {
    const auto data = poly_data(surface.vertices, surface.triangles);
    vtkNew<vtkUnsignedCharArray> colours;
    colours->SetNumberOfComponents(3);
    for (const double value : triangle_values) colours->InsertNextTypedTuple(scale.colour_of(value).data());
    data->GetCellData()->SetScalars(colours);
    const auto actor = actor_of(data, bone, 1);
    actor->GetMapper()->ScalarVisibilityOn();
    actor->GetProperty()->SetInterpolationToFlat();
    actor->GetProperty()->SetSpecular(0);
    actor->GetProperty()->SetAmbient(0.5);
    actor->GetProperty()->SetDiffuse(0.55);
    vtkNew<vtkRenderer> renderer;
    renderer->AddActor(actor);
    return draw(window, renderer, directions, {marked});
}

}  // namespace palpate::report
