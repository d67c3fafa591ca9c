// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/readings/force_columns.hpp"

#include <algorithm>

#include "runtime/visual/quads.hpp"

namespace palpate::visual {

void draw_columns(vtkActor2D* actor, vtkPoints* points, std::span<const Eigen::Vector2d> forces, double top,
                  const Box& box) {
    constexpr double thinnest = 1.5;  // pixels
    const double pixels = top > 0 ? box.height / top : 0;
    const double step = box.width / static_cast<double>(std::max<std::size_t>(1, forces.size()));
    set_quad_count(actor, points, static_cast<vtkIdType>(forces.size()));
    for (std::size_t i = 0; i < forces.size(); ++i) {
        const Eigen::Vector2d& next = forces[std::min(i + 1, forces.size() - 1)];
        const double low = std::min(forces[i][0], next[1]), high = std::max(forces[i][1], next[0]);
        const double left = box.left + step * static_cast<double>(i);
        set_quad(points, static_cast<vtkIdType>(i), left, box.bottom + pixels * low, left + step,
                 box.bottom + std::max(pixels * high, pixels * low + thinnest));
    }
}

}  // namespace palpate::visual
