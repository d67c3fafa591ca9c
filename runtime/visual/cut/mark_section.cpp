// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/cut/mark_section.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <utility>

namespace palpate::visual {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Where the surface crosses the middles of rows, for each row from left to right.
class RowCrossings {
  public:
    explicit RowCrossings(int rows) : rows_(static_cast<std::size_t>(rows)) {}

    // A row that goes through an end belongs to the piece above it alone, so that lines that close cross each
    // row an even number of times.
    void add(Vector2d a, Vector2d b) {
        if (a.y() > b.y()) std::swap(a, b);
        const auto row_from = [&](double y) {
            return static_cast<std::size_t>(
                std::clamp(std::ceil(y - 0.5), 0.0, static_cast<double>(rows_.size())));
        };
        for (std::size_t row = row_from(a.y()); row < row_from(b.y()); ++row) {
            const double share = (static_cast<double>(row) + 0.5 - a.y()) / (b.y() - a.y());
            rows_[row].push_back(a.x() + share * (b.x() - a.x()));
        }
    }

    void fill(int columns, std::vector<unsigned char>& marks) {
        const auto column_from = [&](double x) {
            return static_cast<std::ptrdiff_t>(
                std::clamp(std::ceil(x - 0.5), 0.0, static_cast<double>(columns)));
        };
        for (std::size_t row = 0; row < rows_.size(); ++row) {
            std::ranges::sort(rows_[row]);
            const auto first = marks.begin() + static_cast<std::ptrdiff_t>(row) * columns;
            for (std::size_t i = 0; i + 1 < rows_[row].size(); i += 2)
                std::fill(first + column_from(rows_[row][i]), first + column_from(rows_[row][i + 1]),
                          static_cast<unsigned char>(255));
        }
    }

  private:
    std::vector<std::vector<double>> rows_;
};

}  // namespace

std::vector<unsigned char> mark_section(const TriangleMesh& surface, const ScanPlane& plane, int columns,
                                        int rows) {
    Eigen::Matrix<double, 2, 3> to_cells;
    to_cells << plane.right.transpose() * (columns / plane.width),
        plane.up.transpose() * (rows / plane.height);
    const Vector3d normal = plane.right.cross(plane.up);
    const double height = normal.dot(plane.corner);
    std::vector<double> heights(surface.vertices.size());  // above the plane, mm
    std::ranges::transform(surface.vertices, heights.begin(),
                           [&](const Vector3d& p) { return normal.dot(p) - height; });
    const auto above = [&](std::int32_t vertex) { return !(heights[vertex] < 0); };
    // Where an edge crosses the plane, in cells: its two triangles compute the same, bit for bit.
    const auto crossing = [&](std::int32_t one, std::int32_t other) -> Vector2d {
        const auto [a, b] = std::minmax(one, other);
        const double share = heights[a] / (heights[a] - heights[b]);
        const Vector3d &from = surface.vertices[a], &to = surface.vertices[b];
        return to_cells * (from + share * (to - from) - plane.corner);
    };
    RowCrossings crossings(rows);
    for (const Triangle& t : surface.triangles) {
        const std::array<bool, 3> over{above(t[0]), above(t[1]), above(t[2])};
        if (over[0] == over[1] && over[1] == over[2]) continue;
        // The corner that is alone on its side.
        const std::size_t alone = over[1] == over[2] ? 0 : over[0] == over[2] ? 1 : 2;
        crossings.add(crossing(t[alone], t[(alone + 1) % 3]), crossing(t[alone], t[(alone + 2) % 3]));
    }
    std::vector<unsigned char> marks(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    crossings.fill(columns, marks);
    return marks;
}

}  // namespace palpate::visual
