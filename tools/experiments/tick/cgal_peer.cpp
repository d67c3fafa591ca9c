// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/tick/cgal_peer.hpp"

#include <CGAL/AABB_traits.h>
#include <CGAL/AABB_tree.h>
#include <CGAL/AABB_triangle_primitive.h>
#include <CGAL/Simple_cartesian.h>
#include <vector>

#include "tools/experiments/tick/tick_runs.hpp"

namespace palpate::experiments {
namespace {

using Kernel = CGAL::Simple_cartesian<double>;  // plain double: the fastest there is
using Triangles = std::vector<Kernel::Triangle_3>;
using Primitive = CGAL::AABB_triangle_primitive<Kernel, Triangles::const_iterator>;
using Tree = CGAL::AABB_tree<CGAL::AABB_traits<Kernel, Primitive>>;

Kernel::Point_3 point_of(const Eigen::Vector3d& p) {
    return {p.x(), p.y(), p.z()};
}

}  // namespace

PeerTimes time_cgal(const TriangleMesh& surface, std::span<const Eigen::Vector3d> path) {
    Triangles triangles;
    const auto corner = [&](std::int32_t v) { return point_of(surface.vertices[v]); };
    for (const Triangle& t : surface.triangles)
        triangles.emplace_back(corner(t[0]), corner(t[1]), corner(t[2]));
    PeerTimes times;
    Tree tree;
    times.build_s = 1e-9 * static_cast<double>(nanoseconds_of([&] {
                        tree.insert(triangles.cbegin(), triangles.cend());
                        tree.build();
                    }));
    Kernel::Point_3 last = point_of(path.front()), hint = triangles.front().vertex(0);
    Shortest closest, segment;
    for (int pass = 0; pass < Shortest::passes; ++pass)
        for (std::size_t i = 0; i < path.size(); ++i) {
            const Kernel::Point_3 p = point_of(path[i]);
            closest.record(i, nanoseconds_of([&] { hint = tree.closest_point(p, hint); }));
            if (i > 0 && p != last) {
                const Kernel::Segment_3 step(last, p);
                segment.record(i, nanoseconds_of([&] { keep(tree.do_intersect(step)); }));
            }
            last = p;
        }
    times.closest = closest.histogram();
    times.segment = segment.histogram();
    return times;
}

}  // namespace palpate::experiments
