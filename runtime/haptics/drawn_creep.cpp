// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/drawn_creep.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::haptics {

using Eigen::Vector3f;

DrawnCreep::DrawnCreep(const DeformableBody& body) : creep_(surface_creep_of(body)) {
    if (!creep_.series.empty())
        left_.assign(most_relaxation_terms, std::vector<Vector3f>(creep_.of_vertex.size(), Vector3f::Zero()));
}

void DrawnCreep::follow(double time, std::span<Vector3f> displacements) {
    if (time < last_time_)
        for (std::vector<Vector3f>& left : left_) std::ranges::fill(left, Vector3f::Zero());
    const double passed = std::max(0.0, time - last_time_);
    last_time_ = time;
    for (std::size_t s = 0; s < creep_.series.size(); ++s)
        for (std::size_t k = 0; k < creep_.series[s].size(); ++k) {
            const auto taken = static_cast<float>(1 - std::exp(-passed / creep_.series[s][k].time));
            for (std::size_t v = 0; v < displacements.size(); ++v) {
                if (creep_.of_vertex[v] != static_cast<std::int32_t>(s)) continue;
                left_[k][v] += taken * (displacements[v] - left_[k][v]);
            }
        }
    for (std::size_t v = 0; v < displacements.size() && !left_.empty(); ++v) {
        if (creep_.of_vertex[v] < 0) continue;
        const std::vector<CreepTerm>& series = creep_.series[static_cast<std::size_t>(creep_.of_vertex[v])];
        for (std::size_t k = 0; k < series.size(); ++k)
            displacements[v] += static_cast<float>(series[k].share) * left_[k][v];
    }
}

}  // namespace palpate::haptics
