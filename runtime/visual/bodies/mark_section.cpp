// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/bodies/mark_section.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <utility>

namespace palpate::visual {
namespace {

using Eigen::Vector2d;
using Eigen::Vector3d;

// Where an edge from a to b crosses the plane that they are so far above (third coordinate), which lies
// between.
Vector2d crossing(const Vector3d& a, const Vector3d& b) {
    return a.head<2>() + (b - a).head<2>() * (a.z() / (a.z() - b.z()));
}

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
    // In cells along the plane, and above it.
    Eigen::Matrix3d to_cells;
    to_cells << plane.right.transpose() * (columns / plane.width),
        plane.up.transpose() * (rows / plane.height), plane.right.cross(plane.up).transpose();
    std::vector<Vector3d> places(surface.vertices.size());
    std::ranges::transform(surface.vertices, places.begin(),
                           [&](const Vector3d& p) { return Vector3d(to_cells * (p - plane.corner)); });
    RowCrossings crossings(rows);
    for (const Triangle& t : surface.triangles) {
        std::vector<Vector2d>::size_type count = 0;
        Vector2d ends[2];
        for (std::size_t corner = 0; corner < 3; ++corner) {
            // Both triangles of an edge compute the same point, bit for bit.
            const auto [a, b] = std::minmax(t[corner], t[(corner + 1) % 3]);
            if ((places[a].z() < 0) != (places[b].z() < 0)) ends[count++] = crossing(places[a], places[b]);
        }
        if (count == 2) crossings.add(ends[0], ends[1]);
    }
    std::vector<unsigned char> marks(static_cast<std::size_t>(columns) * static_cast<std::size_t>(rows), 0);
    crossings.fill(columns, marks);
    return marks;
}

}  // namespace palpate::visual
