// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/contract/mesh_to_contract.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <set>

namespace palpate::meshing {
namespace {

// Triangles 0.7 times as long lie about twice as close to a curved surface.
constexpr double finer = 0.7;

void refine_surface(MeshSizing& sizing, std::int32_t region) {
    auto own = std::ranges::find(sizing.regions, region, &RegionSize::region);
    if (own == sizing.regions.end()) own = sizing.regions.insert(own, {.region = region});
    own->surface_scale *= finer;
}

void refine_what_missed(MeshSizing& sizing, const std::vector<ContractCheck>& misses, int attempt,
                        std::span<const std::int32_t> region_values) {
    std::set<std::int32_t> regions;
    for (const ContractCheck& miss : misses) {
        if (!miss.places.empty())
            sizing.near.push_back(
                {.points = miss.places,
                 .within = miss.size,
                 .cell_size = std::min(std::pow(finer, attempt) * miss.size, finer * sizing.cell_size)});
        else if (miss.region > 0)
            regions.insert(miss.region);
        else
            regions.insert(region_values.begin(), region_values.end());
    }
    for (const std::int32_t region : regions) refine_surface(sizing, region);
}

}  // namespace

ContractedMesh mesh_to_contract(const LabelMap& map, std::span<const std::int32_t> region_values,
                                MeshSizing sizing, const QualityContract& contract, int max_attempts,
                                const ProgressCallback& callback) {
    const ProgressCallback progress = callback ? callback : [](std::string_view, double) {};
    constexpr double reachable_deg = 20;  // beyond which optimising whole meshes takes long and fails
    sizing.min_dihedral_deg = std::min(
        reachable_deg,
        std::max({sizing.min_dihedral_deg, contract.min_dihedral_deg, 180 - contract.max_dihedral_deg}));
    require_coarser_than_round_off(sizing, map.grid);
    if (sizing.facet_distance == 0)
        sizing.facet_distance =
            std::min(sizing.cell_size / 10,
                     contract.max_p95_distance * std::max(1.0, std::cbrt(map.grid.voxel_volume())));
    // Fitting and optimising move triangles too: they get what refinement leaves.
    if (sizing.max_gap == 0) sizing.max_gap = 0.6 * contract.max_distance * map.grid.spacing.norm();
    progress("smooth labels", 0);
    const MeshDomain domain =
        prepare_domain(map, region_values, sizing.smoothing, sizing.min_component_volume);
    const std::vector<TriangleMesh> surfaces = region_surfaces(domain.labels, domain.smoothed);
    ContractedMesh result;
    for (int attempt = 1;; ++attempt) {
        const auto step = [&](std::string_view what, double fraction) {
            progress(attempt == 1 ? std::string(what) : fmt::format("{} (attempt {})", what, attempt),
                     fraction);
        };
        result.mesh = tetrahedralise(domain, map, sizing, step);
        step("measure against the contract", 0.95);
        result.measures = measure(result.mesh, domain.labels, surfaces);
        result.checks = check_shape(contract, result.mesh, result.measures.quality);
        const auto fidelity = check_fidelity(contract, result.mesh, result.measures, map.grid);
        result.checks.insert(result.checks.end(), fidelity.begin(), fidelity.end());
        const std::vector<ContractCheck> missed = misses(result.checks);
        result.attempts.push_back({result.mesh.tetrahedra.size(), missed});
        if (missed.empty() || attempt >= max_attempts) return result;
        refine_what_missed(sizing, missed, attempt, region_values);
    }
}

}  // namespace palpate::meshing
