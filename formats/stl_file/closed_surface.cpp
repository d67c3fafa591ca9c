// SPDX-License-Identifier: Apache-2.0
#include "formats/stl_file/closed_surface.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>
#include <sstream>
#include <tuple>
#include <utility>

#include "formats/model/closure.hpp"
#include "formats/model/errors.hpp"

namespace palpate::stl_file {
namespace {

using Eigen::Vector3d;

// Sorted, for a hash's collisions could be chosen by whoever makes the file.
TriangleMesh merged(const std::vector<Corner>& corners) {
    std::vector<std::int32_t> order(corners.size()), first(corners.size());
    std::iota(order.begin(), order.end(), 0);
    const auto corner = [&](std::int32_t i) -> const Corner& { return corners[static_cast<std::size_t>(i)]; };
    std::ranges::sort(order, [&](std::int32_t a, std::int32_t b) {
        return std::pair(corner(a), a) < std::pair(corner(b), b);
    });
    for (std::size_t i = 0; i < order.size(); ++i) {
        const bool same = i > 0 && corner(order[i]) == corner(order[i - 1]);
        first[static_cast<std::size_t>(order[i])] =
            same ? first[static_cast<std::size_t>(order[i - 1])] : order[i];
    }
    TriangleMesh mesh;
    std::vector<std::int32_t>& vertex =
        order;  // of the first corner at each place; what was sorted is done with
    std::ranges::fill(vertex, -1);
    for (std::size_t i = 0; i + 2 < first.size(); i += 3) {
        Triangle t{first[i], first[i + 1], first[i + 2]};
        if (t[0] == t[1] || t[1] == t[2] || t[2] == t[0]) continue;
        for (std::int32_t& index : t) {
            std::int32_t& number = vertex[static_cast<std::size_t>(index)];
            if (number < 0) {
                number = static_cast<std::int32_t>(mesh.vertices.size());
                mesh.vertices.emplace_back(Eigen::Vector3f(corner(index).data()).cast<double>());
            }
            index = number;
        }
        mesh.triangles.push_back(t);
    }
    return mesh;
}

// An edge as a triangle goes along it: from vertex `low` to `high`, or back.
struct DirectedEdge {
    std::int32_t low, high;
    bool back;

    bool same_place(const DirectedEdge& other) const { return low == other.low && high == other.high; }
};

std::vector<DirectedEdge> sorted_edges(const TriangleMesh& mesh) {
    std::vector<DirectedEdge> edges;
    edges.reserve(3 * mesh.triangles.size());
    for (const Triangle& t : mesh.triangles)
        for (std::size_t i = 0; i < 3; ++i) {
            const std::int32_t from = t[i], to = t[(i + 1) % 3];
            edges.push_back({std::min(from, to), std::max(from, to), from > to});
        }
    std::ranges::sort(edges, {},
                      [](const DirectedEdge& edge) { return std::tuple(edge.low, edge.high, edge.back); });
    return edges;
}

std::string written(const Vector3d& p) {
    std::ostringstream out;
    out << '(' << p.x() << ", " << p.y() << ", " << p.z() << ')';
    return out.str();
}

void require_closed(const TriangleMesh& mesh, const std::string& file) {
    const std::vector<DirectedEdge> edges = sorted_edges(mesh);
    for (std::size_t i = 0, next = 0; i < edges.size(); i = next) {
        while (next < edges.size() && edges[next].same_place(edges[i])) ++next;
        if (next - i == 2 && edges[i].back != edges[i + 1].back) continue;
        const auto place = [&](std::int32_t v) {
            return written(mesh.vertices[static_cast<std::size_t>(v)]);
        };
        const std::string how = next - i == 2   ? "two triangles that face opposite sides"
                                : next - i == 1 ? "one triangle"
                                                : std::to_string(next - i) + " triangles";
        throw InvalidInput({file,
                            "is not closed: the edge from " + place(edges[i].low) + " to " +
                                place(edges[i].high) + " mm belongs to " + how,
                            "two, which face the same side", "make it one solid where it was drawn"});
    }
}

// mm³ of a layer on the whole surface, as thick as float32 rounds positions on it.
double rounded_volume(const TriangleMesh& mesh) {
    constexpr double float32_rounding = 6e-8;
    const auto at = [&](std::int32_t v) -> const Vector3d& {
        return mesh.vertices[static_cast<std::size_t>(v)];
    };
    double twice_area = 0, extent = 0;
    for (const Triangle& t : mesh.triangles)
        twice_area += (at(t[1]) - at(t[0])).cross(at(t[2]) - at(t[0])).norm();
    for (const Vector3d& vertex : mesh.vertices) extent = std::max(extent, vertex.cwiseAbs().maxCoeff());
    return twice_area / 2 * extent * float32_rounding;
}

}  // namespace

TriangleMesh closed_surface(const std::vector<Corner>& corners, const std::string& file) {
    TriangleMesh mesh = merged(corners);
    if (mesh.triangles.empty())
        throw InvalidInput({file, "holds no triangles with three corners", "the surface of a tool",
                            "check how it was made"});
    require_closed(mesh, file);
    const double volume = enclosed_volume(mesh);
    if (!(std::abs(volume) > rounded_volume(mesh)))
        throw InvalidInput({file, "encloses no volume", "the surface of a solid", "give it a thickness"});
    if (volume < 0)
        for (Triangle& t : mesh.triangles) std::swap(t[1], t[2]);
    return mesh;
}

}  // namespace palpate::stl_file
