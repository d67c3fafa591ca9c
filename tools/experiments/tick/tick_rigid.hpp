// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <vector>

#include "formats/model/body.hpp"
#include "tools/experiments/tick/tick_runs.hpp"

namespace palpate::experiments {

/// Ticks on a bone along a hand path, by scheme, tool and friction; the queries that they are made of, beside
/// CGAL's on the same path.
struct RigidTicks {
    std::vector<TickRow> rows;
    realtime::Histogram cgal_closest;  ///< ns: what CGAL takes for the point nearest to each position
    double tree_s = 0, surface_s = 0, cgal_tree_s = 0;  ///< to build the OBB tree, the rest, CGAL's tree
    std::int64_t below = 0;                             ///< ticks_below() of all runs with `continuous`
};
RigidTicks rigid_ticks(const TriangleMesh& bone, const devices::HandPath& path);

/// A 1 mm sphere, or a point of 0.01 mm, on a bone.
Case bone_case(const TriangleMesh& bone, double tool_radius, bool friction);

/// The settings of all rows: 0.5 N/mm, and friction 0.3 at rest and 0.2 sliding, or none.
HapticSettings tick_settings(double tool_radius, bool friction);

}  // namespace palpate::experiments
