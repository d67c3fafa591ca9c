// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <algorithm>
#include <boost/optional.hpp>
#include <fmt/format.h>
#include <string>
#include <vector>
#include <vtkIdList.h>
#include <vtkNew.h>
#include <vtkPoints.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStaticPointLocator.h>

#include "formats/model/errors.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

namespace palpate::meshing {
namespace {

using Point = CGAL::Simple_cartesian<double>::Point_3;
using Mesh = CGAL::Surface_mesh<Point>;

Mesh to_cgal(const TriangleMesh& surface) {
    Mesh mesh;
    mesh.reserve(static_cast<unsigned>(surface.vertices.size()),
                 static_cast<unsigned>(3 * surface.triangles.size() / 2),
                 static_cast<unsigned>(surface.triangles.size()));
    for (const Eigen::Vector3d& p : surface.vertices) mesh.add_vertex(Point(p.x(), p.y(), p.z()));
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto vertex = [&](std::size_t c) {
            return Mesh::Vertex_index(static_cast<unsigned>(surface.triangles[t][c]));
        };
        if (mesh.add_face(vertex(0), vertex(1), vertex(2)) == Mesh::null_face())
            throw InvalidInput({"surface", "is not a manifold at triangle " + std::to_string(t),
                                "at most two triangles at an edge, oriented alike",
                                "decimate another surface"});
    }
    return mesh;
}

TriangleMesh from_cgal(Mesh& mesh) {
    mesh.collect_garbage();
    TriangleMesh surface;
    for (const auto vertex : mesh.vertices()) {
        const Point& p = mesh.point(vertex);
        surface.vertices.emplace_back(p.x(), p.y(), p.z());
    }
    for (const auto face : mesh.faces()) {
        Triangle triangle;
        std::size_t corner = 0;
        for (const auto vertex : mesh.vertices_around_face(mesh.halfedge(face)))
            triangle[corner++] = static_cast<std::int32_t>(vertex.idx());
        surface.triangles.push_back(triangle);
    }
    return surface;
}

using Placement = CGAL::Surface_mesh_simplification::Bounded_normal_change_placement<
    CGAL::Surface_mesh_simplification::LindstromTurk_placement<Mesh>>;

// Leaves edges at protected vertices alone.
struct ProtectingPlacement {
    const std::vector<bool>* is_protected;  // by vertex of the full surface
    Placement placement{};

    template <typename Profile>
    boost::optional<Point> operator()(const Profile& profile) const {
        if ((*is_protected)[profile.v0().idx()] || (*is_protected)[profile.v1().idx()]) return boost::none;
        return placement(profile);
    }
};

TriangleMesh decimate_around(const TriangleMesh& surface, std::int64_t max_triangles,
                             const std::vector<bool>& is_protected) {
    namespace simplification = CGAL::Surface_mesh_simplification;
    Mesh mesh = to_cgal(surface);
    // A closed triangle surface has three edges for two triangles.
    const simplification::Count_stop_predicate<Mesh> stop(static_cast<std::size_t>(max_triangles) * 3 / 2);
    simplification::edge_collapse(mesh, stop,
                                  CGAL::parameters::get_cost(simplification::LindstromTurk_cost<Mesh>())
                                      .get_placement(ProtectingPlacement{&is_protected}));
    return from_cgal(mesh);
}

// Protects the corners of a triangle, and `rings` rings of neighbours around all that is protected.
void grow(std::vector<bool>& is_protected, const TriangleMesh& surface, int rings) {
    for (int ring = 0; ring < rings; ++ring) {
        const std::vector<bool> before = is_protected;
        for (const Triangle& t : surface.triangles)
            if (std::ranges::any_of(t, [&](std::int32_t v) { return before[v]; }))
                for (const std::int32_t v : t) is_protected[v] = true;
    }
}

vtkSmartPointer<vtkStaticPointLocator> locator_of(const std::vector<Eigen::Vector3d>& vertices) {
    vtkNew<vtkPoints> points;
    points->SetDataTypeToDouble();
    for (const Eigen::Vector3d& vertex : vertices) points->InsertNextPoint(vertex.data());
    vtkNew<vtkPolyData> data;
    data->SetPoints(points);
    auto locator = vtkSmartPointer<vtkStaticPointLocator>::New();
    locator->SetDataSet(data);
    locator->BuildLocator();
    return locator;
}

// Measures, and protects where the full surface is further than that from the other, or the other from it.
SurfaceDistance protect_far_places(std::vector<bool>& is_protected, const TriangleMesh& full,
                                   const TriangleMesh& coarse, double max_distance) {
    std::vector<bool> far(is_protected.size(), false);
    const auto mark = [&](std::int32_t triangle) {
        for (const std::int32_t v : full.triangles[triangle]) far[v] = true;
    };
    const std::vector<SurfaceSample> of_full = samples_of(full), of_coarse = samples_of(coarse);
    const std::vector<NearestPlace> on_coarse = nearest_places(of_full, coarse),
                                    on_full = nearest_places(of_coarse, full);
    for (std::size_t i = 0; i < of_full.size(); ++i)
        if (on_coarse[i].distance > max_distance) mark(of_full[i].triangle);
    const vtkSmartPointer<vtkStaticPointLocator> around = locator_of(full.vertices);
    vtkNew<vtkIdList> found;
    for (std::size_t i = 0; i < of_coarse.size(); ++i) {
        if (on_full[i].distance <= max_distance) continue;
        // What became this triangle lay around it, not always where the full surface is nearest.
        const Triangle& t = coarse.triangles[of_coarse[i].triangle];
        const auto corner = [&](std::size_t c) { return coarse.vertices[t[c]]; };
        const double reach =
            on_full[i].distance + std::max({(corner(1) - corner(0)).norm(), (corner(2) - corner(1)).norm(),
                                            (corner(0) - corner(2)).norm()});
        around->FindPointsWithinRadius(reach, of_coarse[i].point.data(), found);
        for (const vtkIdType v : *found) far[v] = true;
    }
    constexpr int rings = 2;
    grow(far, full, rings);
    for (std::size_t v = 0; v < far.size(); ++v)
        if (far[v]) is_protected[v] = true;
    return summary(of_full, on_coarse, of_coarse, on_full);
}

}  // namespace

TriangleMesh decimate(const TriangleMesh& surface, std::int64_t max_triangles) {
    if (static_cast<std::int64_t>(surface.triangles.size()) <= max_triangles) return surface;
    return decimate_around(surface, max_triangles, std::vector<bool>(surface.vertices.size(), false));
}

Decimation decimate_within(const TriangleMesh& surface, std::int64_t max_triangles, double max_distance) {
    if (static_cast<std::int64_t>(surface.triangles.size()) <= max_triangles) return {surface, {}};
    constexpr int rounds = 8;
    std::vector<bool> is_protected(surface.vertices.size(), false);
    Decimation best;
    for (int round = 0; round < rounds; ++round) {
        Decimation next{decimate_around(surface, max_triangles, is_protected), {}};
        // Protected triangles may leave too few edges to collapse.
        const std::size_t left = next.surface.triangles.size();
        if (static_cast<std::int64_t>(left) > max_triangles && round == 0)
            throw QualityNotMet(
                {"surface", fmt::format("{} triangles cannot be reached, {} are left", max_triangles, left),
                 "", "allow more triangles"});
        if (static_cast<std::int64_t>(left) > max_triangles) break;
        next.distance = protect_far_places(is_protected, surface, next.surface, max_distance);
        if (round == 0 || next.distance.maximum < best.distance.maximum) best = std::move(next);
        if (best.distance.maximum <= max_distance) return best;
    }
    const Eigen::Vector3d& p = best.distance.farthest;
    throw QualityNotMet({"surface",
                         fmt::format("{} triangles stay {:.3f} mm off at ({:.1f}, {:.1f}, {:.1f})",
                                     max_triangles, best.distance.maximum, p.x(), p.y(), p.z()),
                         fmt::format("{} mm at most", max_distance),
                         "allow more triangles or a larger distance"});
}

}  // namespace palpate::meshing
