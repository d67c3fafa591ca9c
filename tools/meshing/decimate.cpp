// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Simple_cartesian.h>
#include <CGAL/Surface_mesh.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Bounded_normal_change_placement.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/Count_stop_predicate.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_cost.h>
#include <CGAL/Surface_mesh_simplification/Policies/Edge_collapse/LindstromTurk_placement.h>
#include <CGAL/Surface_mesh_simplification/edge_collapse.h>
#include <string>

#include "formats/model/errors.hpp"
#include "tools/meshing/surfaces.hpp"

namespace palpate {
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

}  // namespace

TriangleMesh decimate(const TriangleMesh& surface, std::int64_t max_triangles) {
    if (static_cast<std::int64_t>(surface.triangles.size()) <= max_triangles) return surface;
    namespace simplification = CGAL::Surface_mesh_simplification;
    Mesh mesh = to_cgal(surface);
    // A closed triangle surface has three edges for two triangles.
    const simplification::Count_stop_predicate<Mesh> stop(static_cast<std::size_t>(max_triangles) * 3 / 2);
    simplification::edge_collapse(mesh, stop,
                                  CGAL::parameters::get_cost(simplification::LindstromTurk_cost<Mesh>())
                                      .get_placement(simplification::Bounded_normal_change_placement<
                                                     simplification::LindstromTurk_placement<Mesh>>()));
    return from_cgal(mesh);
}

}  // namespace palpate
