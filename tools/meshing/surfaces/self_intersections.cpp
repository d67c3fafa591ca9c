// SPDX-License-Identifier: GPL-3.0-or-later
#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Intersections_3/Segment_3_Triangle_3.h>
#include <CGAL/Intersections_3/Triangle_3_Triangle_3.h>
#include <CGAL/box_intersection_d.h>
#include <algorithm>

#include "tools/meshing/surfaces/joined_vertices.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

namespace palpate::meshing {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Box = CGAL::Box_intersection_d::Box_with_info_d<double, 3, std::size_t>;

// CGAL's own search in 5.5 takes a Surface_mesh, in which vertices at one place are as many, so that parts
// that touch there would cut each other.
class Triangles {
  public:
    explicit Triangles(const TriangleMesh& surface) : surface_(surface) {}

    bool cross(std::size_t s, std::size_t t) const {
        // What both have comes first.
        Triangle a = surface_.triangles[s], b = surface_.triangles[t];
        const auto in = [](const Triangle& other) {
            return [&other](std::int32_t v) { return std::ranges::find(other, v) != other.end(); };
        };
        const auto shared = std::ranges::partition(a, in(b)).begin() - a.begin();
        std::ranges::partition(b, in(a));
        switch (shared) {
            case 0:
                return CGAL::do_intersect(whole(a), whole(b));
            case 1:
                return CGAL::do_intersect(opposite(a), whole(b)) || CGAL::do_intersect(opposite(b), whole(a));
            case 2:
                return CGAL::coplanar(point(a[0]), point(a[1]), point(a[2]), point(b[2])) &&
                       CGAL::coplanar_orientation(point(a[0]), point(a[1]), point(a[2]), point(b[2])) ==
                           CGAL::POSITIVE;
            default:
                return true;
        }
    }

    Box box(std::size_t t) const { return {whole(surface_.triangles[t]).bbox(), t}; }

  private:
    Kernel::Point_3 point(std::int32_t v) const {
        const Eigen::Vector3d& p = surface_.vertices[static_cast<std::size_t>(v)];
        return {p.x(), p.y(), p.z()};
    }
    Kernel::Triangle_3 whole(const Triangle& t) const { return {point(t[0]), point(t[1]), point(t[2])}; }
    // The edge opposite to the first corner.
    Kernel::Segment_3 opposite(const Triangle& t) const { return {point(t[1]), point(t[2])}; }

    const TriangleMesh& surface_;
};

using Pair = std::array<std::size_t, 2>;

template <typename Visit>
void visit_crossing_pairs(const TriangleMesh& surface, Visit visit) {
    const TriangleMesh joined = joined_vertices(surface);
    const Triangles triangles(joined);
    std::vector<Box> boxes;
    for (std::size_t t = 0; t < joined.triangles.size(); ++t) boxes.push_back(triangles.box(t));
    CGAL::box_self_intersection_d(boxes.begin(), boxes.end(), [&](const Box& a, const Box& b) {
        if (triangles.cross(a.info(), b.info())) visit(Pair{a.info(), b.info()});
    });
}

}  // namespace

std::vector<Pair> self_intersections(const TriangleMesh& surface) {
    std::vector<Pair> pairs;
    visit_crossing_pairs(surface, [&](Pair pair) {
        std::ranges::sort(pair);
        pairs.push_back(pair);
    });
    std::ranges::sort(pairs);
    return pairs;
}

std::optional<Pair> first_self_intersection(const TriangleMesh& surface) {
    try {
        visit_crossing_pairs(surface, [](const Pair& pair) { throw pair; });  // CGAL's only way to stop
    } catch (const Pair& found) {
        return found;
    }
    return {};
}

}  // namespace palpate::meshing
