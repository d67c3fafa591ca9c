// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/soft_ellipsoid.hpp"

#include <array>
#include <cmath>
#include <memory>
#include <utility>

#include "tools/experiments/ellipsoid.hpp"
#include "tools/fem/condensation/condense.hpp"
#include "tools/meshing/tetrahedra/tetrahedralise.hpp"
#include "tools/obb/build_obb_tree.hpp"

namespace palpate::experiments {

using namespace fem;
using Eigen::Index;
using Eigen::Vector3d;

DeformableBody body_of(const Ellipsoid& shape) {
    constexpr std::int32_t organ = 1, border = 3;
    LabelMap map;
    map.names = {{organ, "ellipsoid", default_label_colour(organ)}};
    map.grid.spacing.setOnes();
    for (Index axis = 0; axis < 3; ++axis) {
        const double reach = std::ceil(shape.semi_axes[axis]) + border;
        map.grid.size[axis] = static_cast<std::int32_t>(2 * reach) + 1;
        map.grid.origin[axis] = -reach;
    }
    for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < map.grid.size[0]; ++i) {
                const Vector3d p = map.grid.point_of(Vector3d(i, j, k));
                map.labels.push_back(p.cwiseQuotient(shape.semi_axes).squaredNorm() <= 1 ? organ : 0);
            }
    meshing::MeshSizing sizing;
    sizing.cell_size = 0.87 * shape.spacing;
    sizing.facet_size = 0.92 * shape.spacing;
    const double cut = 0.6 * shape.held_side * shape.semi_axes.z();
    DeformableBody body = held_body(meshing::tetrahedralise(map, std::array{organ}, sizing),
                                    {"plane", BeyondPlane{{0, 0, cut}, {0, 0, shape.held_side}}});
    for (RegionMaterial& region : body.materials) region.material.poissons_ratio = shape.poissons_ratio;
    body.compliance = to_stored(condense_by_trailing_block(body, [](std::string_view, double) {}));
    body.obb_tree = obb::build_obb_tree(body.boundary.surface);
    return body;
}

DeformableBody changed(DeformableBody body, double stiffness, double sign) {
    auto& compliance = std::get<DenseCompliance>(body.compliance);
    const std::size_t n = compliance.dof_count();
    const std::shared_ptr<float[]> entries(new float[n * n]);
    for (std::size_t i = 0; i < n; ++i)
        for (std::size_t j = 0; j < n; ++j)
            entries[i * n + j] =
                static_cast<float>((i % 3 == 2 ? sign : 1) * (j % 3 == 2 ? sign : 1) / stiffness) *
                compliance.row(i)[j];
    compliance.entries = std::shared_ptr<const float>(entries, entries.get());
    if (sign > 0) return body;
    for (Vector3d& p : body.boundary.surface.vertices) p.z() = -p.z();
    for (Triangle& t : body.boundary.surface.triangles) std::swap(t[1], t[2]);
    body.obb_tree = obb::build_obb_tree(body.boundary.surface);
    return body;
}

}  // namespace palpate::experiments
