// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Polygon_mesh_processing/self_intersections.h>
#include <CGAL/Surface_mesh.h>
#include <iterator>
#include <string>
#include <utility>
#include <vector>

#include "formats/model/errors.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

namespace palpate::meshing {

std::int64_t self_intersections(const TriangleMesh& surface) {
    using Mesh = CGAL::Surface_mesh<CGAL::Exact_predicates_inexact_constructions_kernel::Point_3>;
    Mesh mesh;
    for (const Eigen::Vector3d& p : surface.vertices) mesh.add_vertex({p.x(), p.y(), p.z()});
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        const auto vertex = [&](std::size_t c) {
            return Mesh::Vertex_index(static_cast<unsigned>(surface.triangles[t][c]));
        };
        if (mesh.add_face(vertex(0), vertex(1), vertex(2)) == Mesh::null_face())
            throw InvalidInput({"surface", "is not a manifold at triangle " + std::to_string(t),
                                "at most two triangles at an edge, oriented alike", "repair it first"});
    }
    std::vector<std::pair<Mesh::Face_index, Mesh::Face_index>> pairs;
    CGAL::Polygon_mesh_processing::self_intersections(mesh, std::back_inserter(pairs));
    return static_cast<std::int64_t>(pairs.size());
}

}  // namespace palpate::meshing
