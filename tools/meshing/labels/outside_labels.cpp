// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/labels/outside_labels.hpp"

#include <Eigen/Geometry>
#include <cmath>
#include <optional>

namespace palpate::meshing {
namespace {

class OutsideProbe {
  public:
    OutsideProbe(const TetMesh& mesh, const LabelMap& map)
        : map_(map),
          body_(65536, false),
          step_(0.25 * map.grid.spacing.minCoeff()),
          reach_(2 * map.grid.spacing.norm()) {
        for (const std::int32_t region : mesh.regions) body_[region] = true;
    }

    std::int32_t label_beyond(const Eigen::Vector3d& p, const Eigen::Vector3d& normal) const {
        if (const auto met = walk(p, normal, reach_)) return met->label;
        std::optional<Meeting> nearest;
        for (int k = -1; k <= 1; ++k)
            for (int j = -1; j <= 1; ++j)
                for (int i = -1; i <= 1; ++i) {
                    if (i == 0 && j == 0 && k == 0) continue;
                    const auto met = walk(p, Eigen::Vector3d(i, j, k).normalized(),
                                          nearest ? nearest->distance - step_ : reach_);
                    if (met) nearest = met;
                }
        return nearest ? nearest->label : 0;
    }

  private:
    struct Meeting {
        std::int32_t label;
        double distance;
    };

    std::optional<Meeting> walk(const Eigen::Vector3d& p, const Eigen::Vector3d& direction,
                                double reach) const {
        for (double distance = 0; distance <= reach; distance += step_) {
            const std::int32_t label = label_at(p + distance * direction);
            if (!body_[label]) return Meeting{label, distance};
        }
        return std::nullopt;
    }

    std::int32_t label_at(const Eigen::Vector3d& p) const {
        const Eigen::Vector3d index = map_.grid.index_of(p);
        const auto i = static_cast<std::int32_t>(std::lround(index.x()));
        const auto j = static_cast<std::int32_t>(std::lround(index.y()));
        const auto k = static_cast<std::int32_t>(std::lround(index.z()));
        return map_.grid.contains(i, j, k) ? map_.labels[map_.grid.offset(i, j, k)] : 0;
    }

    const LabelMap& map_;
    std::vector<bool> body_;
    double step_, reach_;
};

}  // namespace

std::vector<std::int32_t> outside_labels(const TetMesh& mesh, const LabelMap& map) {
    const BoundarySurface boundary = boundary_surface(mesh);
    const std::vector<Eigen::Vector3d> normals = surface_normals(boundary.surface);
    const OutsideProbe probe(mesh, map);
    std::vector<std::int32_t> labels(mesh.rest_positions.size(), -1);
    for (std::size_t v = 0; v < boundary.nodes.size(); ++v)
        labels[boundary.nodes[v]] = probe.label_beyond(boundary.surface.vertices[v], normals[v]);
    return labels;
}

}  // namespace palpate::meshing
