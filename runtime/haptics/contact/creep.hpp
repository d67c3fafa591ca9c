// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "formats/model/body.hpp"
#include "runtime/haptics/contact/fixed_list.hpp"

namespace palpate::haptics {

/// A term of the series by which tissue gives way under a lasting force:
///     C(t) = C (1 + sum share_k (1 - exp(-t / time_k))).
struct CreepTerm {
    double share = 0;  ///< of C
    double time = 0;   ///< s
    bool operator==(const CreepTerm&) const = default;
};

/// The creep of a material that relaxes so (see RelaxationTerm), exactly, as many terms by ascending time.
/// The series must be sound: relaxation_error() (asserted). Derivation in creep.cpp.
std::vector<CreepTerm> creep_of(std::span<const RelaxationTerm> relaxation);

/// What a creep series comes to in ticks of one length T:
///     C_now = now C,    now = 1 + sum share_k (1 - decay_k),    decay_k = exp(-T / time_k).
struct TickCreep {
    struct Term {
        double share = 0, decay = 0;
    };
    FixedList<Term, most_relaxation_terms> terms;
    double now = 1;
    std::int64_t memory_ticks = 0;  ///< after which a load is forgotten

    /// `period` in s.
    TickCreep(std::span<const CreepTerm> creep, double period);
};

/// What is left of loads that came before, or of what they displaced by C: q_k of
///     dq_k/dt = (f - q_k) / time_k,    u = C (f + sum share_k q_k),
/// the load of a tick counted as if it had lasted all of it, which adds no energy. Realtime-safe.
struct CreepHistory {
    std::array<Eigen::Vector3d, most_relaxation_terms> left = nothing();

    /// Takes in a tick's load.
    void take(const TickCreep& creep, const Eigen::Vector3d& load) noexcept {
        for (std::size_t k = 0; k < creep.terms.size(); ++k)
            left[k] += (1 - creep.terms[k].decay) * (load - left[k]);
    }
    /// What counts in the next tick besides `now` times its load.
    Eigen::Vector3d lasting(const TickCreep& creep) const noexcept {
        Eigen::Vector3d sum = Eigen::Vector3d::Zero();
        for (std::size_t k = 0; k < creep.terms.size(); ++k)
            sum += creep.terms[k].share * creep.terms[k].decay * left[k];
        return sum;
    }

  private:
    static std::array<Eigen::Vector3d, most_relaxation_terms> nothing() noexcept {
        std::array<Eigen::Vector3d, most_relaxation_terms> zero;
        zero.fill(Eigen::Vector3d::Zero());
        return zero;
    }
};

/// How the surface of a body creeps: a vertex as the region does that most of the volume about it is of.
struct SurfaceCreepSeries {
    std::vector<std::vector<CreepTerm>> series;  ///< all different, none empty
    std::vector<std::int32_t> of_vertex;  ///< of each surface vertex: an index into them, -1 where it does
                                          ///< not creep; empty if nothing does
};
SurfaceCreepSeries surface_creep_of(const DeformableBody& body);

}  // namespace palpate::haptics
