// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/creep.hpp"

#include <algorithm>
#include <cassert>
#include <cmath>
#include <map>
#include <numeric>

// The relaxation and the creep of a material, each transformed by Laplace and multiplied by s, are reciprocal
// (Tschoegl 1989). With L = -1 / s,
//     E(L) / E = h(L) = 1 - sum g_i L / (L - t_i),    C(L) / C = 1 / h(L) = 1 + sum c_k L / (L - l_k):
// the times l_k of creep are the zeros of h, of which one lies above each t_i and below the next, since
//     h'(L) = sum g_i t_i / (L - t_i)²
// is positive, h falls to -inf right above t_i and rises to inf right below the next; the last lies at
// t_n / (1 - sum g_i) at most. The shares are c_k = 1 / (l_k h'(l_k)). One term has c = g / (1 - g) and
// l = t / (1 - g).

namespace palpate::haptics {
namespace {

constexpr double forgotten_in = 12;  // times the longest: then 6e-6 of a displacement is left

double modulus_at(std::span<const RelaxationTerm> relaxation, double time) {
    double h = 1;
    for (const auto& [share, t] : relaxation) h -= share * time / (time - t);
    return h;
}

double slope_at(std::span<const RelaxationTerm> relaxation, double time) {
    double slope = 0;
    for (const auto& [share, t] : relaxation) slope += share * t / ((time - t) * (time - t));
    return slope;
}

}  // namespace

std::vector<CreepTerm> creep_of(std::span<const RelaxationTerm> relaxation) {
    assert(!relaxation_error(relaxation));
    double left = 1;
    for (const RelaxationTerm& term : relaxation) left -= term.share;
    std::vector<CreepTerm> creep;
    for (std::size_t i = 0; i < relaxation.size(); ++i) {
        double low = relaxation[i].time,
               high = i + 1 < relaxation.size() ? relaxation[i + 1].time : low / left;
        // By halves to the last bit: below the zero, h is negative.
        for (double middle = std::midpoint(low, high); low < middle && middle < high;
             middle = std::midpoint(low, high))
            (modulus_at(relaxation, middle) < 0 ? low : high) = middle;
        creep.push_back({1 / (high * slope_at(relaxation, high)), high});
    }
    return creep;
}

TickCreep::TickCreep(std::span<const CreepTerm> creep, double period) {
    for (const auto& [share, time] : creep) {
        terms.push_back({share, std::exp(-period / time)});
        now += share * (1 - terms[terms.size() - 1].decay);
        memory_ticks = std::max(memory_ticks, static_cast<std::int64_t>(forgotten_in * time / period));
    }
}

SurfaceCreepSeries surface_creep_of(const DeformableBody& body) {
    SurfaceCreepSeries creep;
    if (body.relaxation.empty()) return creep;
    std::map<std::int32_t, std::int32_t> series_of;  // by region
    for (const RegionRelaxation& entry : body.relaxation) {
        if (series_of.contains(entry.region)) continue;
        const std::vector<CreepTerm> series = creep_of(relaxation_of(body, entry.region));
        const auto known = std::ranges::find(creep.series, series);
        series_of[entry.region] = static_cast<std::int32_t>(known - creep.series.begin());
        if (known == creep.series.end()) creep.series.push_back(series);
    }
    std::vector<std::map<std::int32_t, double>> volumes(body.mesh.rest_positions.size());  // by region
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t)
        for (const std::int32_t node : body.mesh.tetrahedra[t])
            volumes[static_cast<std::size_t>(node)][body.mesh.regions[t]] += six_volume(body.mesh, t);
    for (const std::int32_t node : body.boundary.nodes) {
        const auto& about = volumes[static_cast<std::size_t>(node)];
        const auto most = std::ranges::max_element(about, {}, [](const auto& entry) { return entry.second; });
        const auto found = most == about.end() ? series_of.end() : series_of.find(most->first);
        creep.of_vertex.push_back(found == series_of.end() ? -1 : found->second);
    }
    return creep;
}

}  // namespace palpate::haptics
