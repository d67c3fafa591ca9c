// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <span>

#include "formats/model/triangle_mesh.hpp"
#include "runtime/realtime/histogram.hpp"

namespace palpate::experiments {

/// What CGAL's AABB tree takes for the two queries that a tick is made of.
struct PeerTimes {
    double build_s = 0;
    realtime::Histogram closest, segment;  ///< ns
};

/// Builds the tree over a surface and, along a path (mm), asks for the point nearest to each position,
/// starting from the last answer, and whether each step meets the surface.
PeerTimes time_cgal(const TriangleMesh& surface, std::span<const Eigen::Vector3d> path);

}  // namespace palpate::experiments
