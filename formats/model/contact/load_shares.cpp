// SPDX-License-Identifier: Apache-2.0
#include "formats/model/contact/load_shares.hpp"

#include <algorithm>
#include <cmath>

#include "formats/model/contact/surface_walk.hpp"

// A point force on a mesh of tetrahedra meets the mesh's compliance, which grows as 1 / h and changes with
// the place between nodes, not the tissue's. So a contact's force f is spread over a disc of radius R of some
// elements, with the density
//     k(rho) = 3 / (pi R²) (1 - rho² / R²)²,
// and the displacement there averaged with the same density: C becomes S C S', S_vj the share of vertex j in
// the disc about vertex v. Any mesh gets that compliance right, for it is smooth on the mesh's scale. What a
// sphere sinks into the tissue besides stands in local_indentation.cpp.

namespace palpate {
namespace {

// R, in edges' lengths: of those that a quarter are shorter than, so that a refined place decides.
constexpr double elements_in_radius = 2.5;
// What R² gains by linear elements, in edges' lengths squared. R²/4 is the density's second moment, to which
// sharing forces between vertices among them adds e²/4 on the mean, in equilateral triangles of edge e. As
// much again was measured: linear elements are too stiff under what changes within one. How much more tissue
// gives way to the narrower of two discs, 2 says too large by 6 % on a cube (1: by 24 %), as
// LoadSpread.a_narrower_disc_gives_way_more_as_its_radius_says measures, and within 1 % on flat parts of the
// demo's liver and nasopharynx (1: by 16 %), but by 22 % on those of a brain, as
// tests/benchmarks/spread_discs.py does.
constexpr double edges_squared = 2;
constexpr double same_side = 0.3;  // cosine between normals that a disc takes together

// The length that a quarter of the edges between vertices with a block are shorter than, mm; 0 if there are
// none.
double short_edge(const TriangleMesh& mesh, std::span<const std::int32_t> blocks) {
    std::vector<double> lengths;
    for (const Triangle& t : mesh.triangles)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const auto a = static_cast<std::size_t>(t[corner]),
                       b = static_cast<std::size_t>(t[(corner + 1) % 3]);
            if (blocks[a] >= 0 && blocks[b] >= 0)
                lengths.push_back((mesh.vertices[a] - mesh.vertices[b]).norm());
        }
    if (lengths.empty()) return 0;
    const auto quarter = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 4);
    std::ranges::nth_element(lengths, quarter);
    return *quarter;
}

SpreadDisc disc_of(double reach, double edge) {
    return {reach, std::sqrt(reach * reach + edges_squared * edge * edge)};
}

}  // namespace

SpreadDisc spread_disc(const DeformableBody& body, std::span<const std::int32_t> blocks) {
    const double edge = short_edge(body.boundary.surface, blocks);
    return disc_of(elements_in_radius * edge, edge);
}

SpreadDisc widened(const SpreadDisc& disc, double reach) {
    if (reach <= disc.reach) return disc;
    return disc_of(reach, disc.reach / elements_in_radius);
}

LoadShares load_shares(const DeformableBody& body, std::span<const std::int32_t> blocks, double reach) {
    const TriangleMesh& mesh = body.boundary.surface;
    const auto [areas, normals] = vertex_shapes(mesh);
    SurfaceWalk walk(mesh);
    LoadShares result;
    result.first.push_back(0);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const auto same = [&](std::int32_t other) {
            return normals[static_cast<std::size_t>(other)].dot(normals[v]) > same_side;
        };
        double sum = 0;
        const std::size_t first = result.shares.size();
        // What does not give way does not spread either.
        if (blocks[v] >= 0)
            for (const std::int32_t other : walk.within(static_cast<std::int32_t>(v), reach, same)) {
                const auto j = static_cast<std::size_t>(other);
                const double squared = (mesh.vertices[j] - mesh.vertices[v]).squaredNorm();
                const double inside = squared > 0 ? 1 - squared / (reach * reach) : 1;
                const double weight = areas[j] * inside * inside;
                const bool gives_way = blocks[j] >= 0;
                if (gives_way || std::ranges::binary_search(body.fixed_nodes, body.boundary.nodes[j]))
                    sum += weight;
                if (!gives_way) continue;
                result.shares.push_back({other, static_cast<float>(weight)});
            }
        for (std::size_t k = first; k < result.shares.size(); ++k)
            result.shares[k].weight /= static_cast<float>(sum);
        result.first.push_back(result.shares.size());
    }
    return result;
}

double surface_contact_modulus(const DeformableBody& body) {
    const auto at_surface = [&](std::int32_t node) {
        return std::ranges::binary_search(body.contact_nodes, node);
    };
    double compliance = 0;
    std::size_t count = 0;
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
        if (std::ranges::none_of(body.mesh.tetrahedra[t], at_surface)) continue;
        const auto found = std::ranges::find(body.materials, body.mesh.regions[t], &RegionMaterial::region);
        if (found == body.materials.end()) continue;
        const auto [youngs_modulus, poissons_ratio] = found->material;
        compliance += (1 - poissons_ratio * poissons_ratio) / youngs_modulus;
        ++count;
    }
    return count > 0 ? static_cast<double>(count) / compliance : 0;
}

}  // namespace palpate
