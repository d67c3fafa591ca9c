// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/condensation/sway.hpp"

#include <Eigen/Geometry>
#include <fmt/format.h>

namespace palpate::fem {
namespace {

using Eigen::Index;

constexpr double felt_just = 0.1;  // N, of a light touch
constexpr double most_of_its_extent = 0.25;

}  // namespace

std::array<ContactLoad, 3> spread_newtons(const DeformableBody& body) {
    std::array<ContactLoad, 3> loads;
    const auto count = static_cast<std::int32_t>(body.contact_nodes.size());
    for (int axis = 0; axis < 3; ++axis)
        for (std::int32_t node = 0; node < count; ++node)
            loads[static_cast<std::size_t>(axis)].push_back(
                {node, Eigen::Vector3f::Unit(axis) / static_cast<float>(count)});
    return loads;
}

Sway sway_of(const DeformableBody& body, const Eigen::MatrixXd& displacements) {
    Sway sway;
    for (Index load = 0; load < displacements.rows(); ++load)
        for (std::size_t node = 0; node < body.contact_nodes.size(); ++node) {
            const double distance =
                felt_just * displacements.block<1, 3>(load, 3 * static_cast<Index>(node)).norm();
            if (distance > sway.distance)
                sway = {distance, body.mesh.rest_positions[body.contact_nodes[node]]};
        }
    return sway;
}

Sway sway_of(const DeformableBody& body) {
    const auto loads = spread_newtons(body);
    const std::size_t nodes = body.contact_nodes.size();
    Eigen::MatrixXd displacements(3, 3 * static_cast<Index>(nodes));
    for (std::size_t axis = 0; axis < 3; ++axis) {
        std::vector<Eigen::Vector3f> moved(nodes, Eigen::Vector3f::Zero());
        add_displacements(body.compliance, loads[axis], moved);
        displacements.row(static_cast<Index>(axis)) =
            Eigen::Map<const Eigen::RowVectorXf>(moved.front().data(), displacements.cols()).cast<double>();
    }
    return sway_of(body, displacements);
}

bool hangs(const DeformableBody& body, const Sway& sway) {
    Eigen::AlignedBox3d box;
    for (const Eigen::Vector3d& point : body.mesh.rest_positions) box.extend(point);
    return sway.distance > most_of_its_extent * box.diagonal().norm();
}

std::string hanging_text(const Sway& sway) {
    return fmt::format(
        "hangs: 0.1 N spread over it moves it by {:.3g} mm around ({:.0f}, {:.0f}, {:.0f}), of "
        "which linear elasticity says nothing",
        sway.distance, sway.place.x(), sway.place.y(), sway.place.z());
}

}  // namespace palpate::fem
