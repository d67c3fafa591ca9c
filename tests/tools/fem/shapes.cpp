// SPDX-License-Identifier: GPL-3.0-or-later
#include "tests/tools/fem/shapes.hpp"

#include <algorithm>
#include <cmath>
#include <numbers>

namespace palpate::test {

PlaneMesh cut_triangle(int n) {
    PlaneMesh mesh;
    const auto id = [](int i, int j) { return i * (i + 1) / 2 + j; };  // j of 0 ... i in row i
    for (int i = 0; i <= n; ++i)
        for (int j = 0; j <= i; ++j) mesh.points.emplace_back(double(i - j) / n, double(j) / n);
    for (int i = 0; i < n; ++i)
        for (int j = 0; j <= i; ++j) {
            mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
            if (j < i) mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
        }
    return mesh;
}

PlaneMesh cut_square(int along_u, int along_v) {
    PlaneMesh mesh;
    const auto id = [&](int i, int j) { return j * (along_u + 1) + i; };
    for (int j = 0; j <= along_v; ++j)
        for (int i = 0; i <= along_u; ++i) mesh.points.emplace_back(double(i) / along_u, double(j) / along_v);
    for (int j = 0; j < along_v; ++j)
        for (int i = 0; i < along_u; ++i) {
            mesh.triangles.push_back({id(i, j), id(i + 1, j), id(i + 1, j + 1)});
            mesh.triangles.push_back({id(i, j), id(i + 1, j + 1), id(i, j + 1)});
        }
    return mesh;
}

PlaneMesh cut_disc(const std::vector<double>& radii, int sectors, double angle, int most_segments) {
    PlaneMesh mesh;
    const bool closed = angle > 2 * std::numbers::pi - 1e-9;
    std::vector<int> first;  // point of each ring, the centre being ring 0
    const auto segments = [&](int ring) { return std::min(ring, most_segments); };
    const auto id = [&](int ring, int sector, int step) {
        const int in_ring = sectors * segments(ring);
        const int position = sector * segments(ring) + step;
        return first[static_cast<std::size_t>(ring)] +
               (in_ring == 0 ? 0 : (closed ? position % in_ring : position));
    };
    for (int ring = 0; ring < static_cast<int>(radii.size()); ++ring) {
        first.push_back(static_cast<int>(mesh.points.size()));
        const int in_ring = sectors * segments(ring);
        for (int k = 0; k < std::max(1, closed || in_ring == 0 ? in_ring : in_ring + 1); ++k) {
            const double at = in_ring == 0 ? 0 : angle * k / in_ring;
            mesh.points.push_back(radii[static_cast<std::size_t>(ring)] *
                                  Eigen::Vector2d(std::cos(at), std::sin(at)));
        }
    }
    for (int ring = 0; ring + 1 < static_cast<int>(radii.size()); ++ring)
        for (int sector = 0; sector < sectors; ++sector)
            for (int k = 0; k < segments(ring + 1); ++k) {
                const std::array<std::int32_t, 2> outer{id(ring + 1, sector, k), id(ring + 1, sector, k + 1)};
                // The last segment of a ring that has one more than the ring inside meets a point, not a
                // segment.
                const bool pointed = k == segments(ring);
                const std::int32_t inner = id(ring, sector, k);
                mesh.triangles.push_back({inner, outer[0], outer[1]});
                if (!pointed) mesh.triangles.push_back({inner, outer[1], id(ring, sector, k + 1)});
            }
    return mesh;
}

TetMesh sweep(const PlaneMesh& plane, int layers,
              const std::function<Eigen::Vector3d(const Eigen::Vector2d&, int border)>& place) {
    TetMesh mesh;
    for (int border = 0; border <= layers; ++border)
        for (const Eigen::Vector2d& point : plane.points) mesh.rest_positions.push_back(place(point, border));
    const auto per_border = static_cast<std::int32_t>(plane.points.size());
    for (int layer = 0; layer < layers; ++layer)
        for (auto corner : plane.triangles) {
            // Every side of a prism is cut from the lower number's bottom to the higher number's top, so
            // neighbours agree on the diagonal.
            std::ranges::sort(corner);
            const auto [a, b, c] = corner;
            const std::int32_t bottom = layer * per_border, top = bottom + per_border;
            for (const Tetrahedron& tet : {Tetrahedron{bottom + a, bottom + b, bottom + c, top + c},
                                           {bottom + a, bottom + b, top + b, top + c},
                                           {bottom + a, top + a, top + b, top + c}}) {
                mesh.tetrahedra.push_back(tet);
                mesh.regions.push_back(1);
                if (six_volume(mesh, mesh.tetrahedra.size() - 1) < 0)
                    std::swap(mesh.tetrahedra.back()[2], mesh.tetrahedra.back()[3]);
            }
        }
    mesh.region_names = {{1, "body", {1, 0, 0}}};
    return mesh;
}

TetMesh hollow_sphere_octant(double inner_radius, double outer_radius, int around, int through) {
    return sweep(cut_triangle(around), through, [&](const Eigen::Vector2d& p, int border) {
        const Eigen::Vector3d direction(p.x(), p.y(), 1 - p.x() - p.y());
        return Eigen::Vector3d((inner_radius + (outer_radius - inner_radius) * border / through) *
                               direction.normalized());
    });
}

TetMesh tube_quarter(double inner_radius, double outer_radius, double thickness, int around, int through) {
    return sweep(cut_square(through, around), 1, [&](const Eigen::Vector2d& p, int border) {
        const double radius = inner_radius * std::pow(outer_radius / inner_radius, p.x());
        const double angle = p.y() * std::numbers::pi / 2;
        // The end faces are met exactly, so that supports find their nodes.
        const double x = p.y() == 1 ? 0 : std::cos(angle), y = p.y() == 0 ? 0 : std::sin(angle);
        return Eigen::Vector3d(radius * x, radius * y, thickness * border);
    });
}

}  // namespace palpate::test
