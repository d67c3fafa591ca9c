// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/tetrahedra/body_repair.hpp"

#include <algorithm>
#include <map>

#include "formats/model/disjoint_sets.hpp"
#include "tools/meshing/measures/quality.hpp"
#include "tools/meshing/measures/tet_faces.hpp"

namespace palpate::meshing {
namespace {

using Edge = std::array<std::int32_t, 2>;  // ascending

// Edges in more than two faces of the boundary.
std::map<Edge, std::vector<std::size_t>> pinched_edges(const TetMesh& mesh) {
    std::map<Edge, int> faces_at;
    const std::vector<TetFace> faces = sorted_faces(mesh);
    for (std::size_t i = 0; i < faces.size();) {
        const bool shared = i + 1 < faces.size() && faces[i + 1].sorted_nodes == faces[i].sorted_nodes;
        const auto& [a, b, c] = faces[i].sorted_nodes;
        if (!shared)
            for (const Edge& edge : {Edge{a, b}, Edge{b, c}, Edge{a, c}}) ++faces_at[edge];
        i += shared ? 2 : 1;
    }
    std::map<Edge, std::vector<std::size_t>> pinched;
    for (const auto& [edge, count] : faces_at)
        if (count > 2) pinched[edge];
    if (pinched.empty()) return pinched;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) {
        Tetrahedron nodes = mesh.tetrahedra[t];
        std::ranges::sort(nodes);
        for (std::size_t a = 0; a < 4; ++a)
            for (std::size_t b = a + 1; b < 4; ++b)
                if (const auto found = pinched.find({nodes[a], nodes[b]}); found != pinched.end())
                    found->second.push_back(t);
    }
    return pinched;
}

// The tetrahedra of the smallest of the fans (tetrahedra that share faces with the edge) around an edge.
std::vector<std::size_t> smallest_fan(const TetMesh& mesh, const std::vector<std::size_t>& around) {
    DisjointSets fans(around.size());
    for (std::size_t a = 0; a < around.size(); ++a)
        for (std::size_t b = a + 1; b < around.size(); ++b)
            if (std::ranges::count_if(mesh.tetrahedra[around[a]], [&](std::int32_t node) {
                    return std::ranges::count(mesh.tetrahedra[around[b]], node) > 0;
                }) == 3)
                fans.join(a, b);
    std::map<std::size_t, double> volumes;
    for (std::size_t a = 0; a < around.size(); ++a) volumes[fans.root(a)] += six_volume(mesh, around[a]);
    const auto smallest = std::ranges::min_element(
        volumes, {}, [](const std::pair<const std::size_t, double>& fan) { return fan.second; });
    std::vector<std::size_t> fan;
    for (std::size_t a = 0; a < around.size(); ++a)
        if (fans.root(a) == smallest->first) fan.push_back(around[a]);
    return fan;
}

// Keeps the tetrahedra for which `keep` holds, and the nodes that they use, in order of use.
void keep_tetrahedra(TetMesh& mesh, const std::vector<bool>& keep) {
    TetMesh kept;
    std::vector<std::int32_t> node_of(mesh.rest_positions.size(), -1);
    for (std::size_t t = 0; t < keep.size(); ++t) {
        if (!keep[t]) continue;
        Tetrahedron tet = mesh.tetrahedra[t];
        for (std::int32_t& node : tet) {
            std::int32_t& id = node_of[node];
            if (id < 0) {
                id = static_cast<std::int32_t>(kept.rest_positions.size());
                kept.rest_positions.push_back(mesh.rest_positions[node]);
            }
            node = id;
        }
        kept.tetrahedra.push_back(tet);
        kept.regions.push_back(mesh.regions[t]);
    }
    mesh.rest_positions = std::move(kept.rest_positions);
    mesh.tetrahedra = std::move(kept.tetrahedra);
    mesh.regions = std::move(kept.regions);
}

}  // namespace

std::int64_t split_hinges(TetMesh& mesh) {
    // Corners of tetrahedra that share a face are one node; corners that only share a node are not.
    DisjointSets corners(4 * mesh.tetrahedra.size());
    const auto corner_at = [&](std::size_t tet, std::int32_t node) {
        return 4 * tet + static_cast<std::size_t>(std::ranges::find(mesh.tetrahedra[tet], node) -
                                                  mesh.tetrahedra[tet].begin());
    };
    const std::vector<TetFace> faces = sorted_faces(mesh);
    for (std::size_t i = 1; i < faces.size(); ++i)
        if (faces[i].sorted_nodes == faces[i - 1].sorted_nodes)
            for (const std::int32_t node : faces[i].sorted_nodes)
                corners.join(corner_at(faces[i].tet, node), corner_at(faces[i - 1].tet, node));

    const std::size_t nodes_before = mesh.rest_positions.size();
    std::vector<bool> taken(nodes_before, false);
    std::vector<std::int32_t> node_of(4 * mesh.tetrahedra.size(), -1);
    for (std::size_t corner = 0; corner < node_of.size(); ++corner) {
        std::int32_t& own = mesh.tetrahedra[corner / 4][corner % 4];
        std::int32_t& chosen = node_of[corners.root(corner)];
        if (chosen < 0) {
            chosen = own;
            if (taken[own]) {
                chosen = static_cast<std::int32_t>(mesh.rest_positions.size());
                mesh.rest_positions.push_back(mesh.rest_positions[own]);
            }
            taken[own] = true;
        }
        own = chosen;
    }
    return static_cast<std::int64_t>(mesh.rest_positions.size() - nodes_before);
}

std::int64_t absorb_islands(TetMesh& mesh, double min_volume) {
    const std::vector<TetFace> faces = sorted_faces(mesh);
    const auto each_shared_face = [&](const auto& visit) {
        for (std::size_t i = 1; i < faces.size(); ++i)
            if (faces[i].sorted_nodes == faces[i - 1].sorted_nodes) visit(faces[i - 1], faces[i]);
    };
    DisjointSets islands(mesh.tetrahedra.size());
    each_shared_face([&](const TetFace& a, const TetFace& b) {
        if (mesh.regions[a.tet] == mesh.regions[b.tet]) islands.join(a.tet, b.tet);
    });
    std::map<std::size_t, double> volumes;                     // by root
    std::map<std::int32_t, std::size_t> largest;               // root, by region
    std::map<std::size_t, std::map<std::int32_t, int>> touch;  // faces shared with each region, by root
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        volumes[islands.root(t)] += six_volume(mesh, t) / 6;
    for (const auto& [root, volume] : volumes) {
        const auto [entry, first] = largest.try_emplace(mesh.regions[root], root);
        if (!first && volume > volumes[entry->second]) entry->second = root;
    }
    each_shared_face([&](const TetFace& a, const TetFace& b) {
        if (mesh.regions[a.tet] == mesh.regions[b.tet]) return;
        ++touch[islands.root(a.tet)][mesh.regions[b.tet]];
        ++touch[islands.root(b.tet)][mesh.regions[a.tet]];
    });
    std::map<std::size_t, std::int32_t> new_region;
    for (const auto& [root, regions] : touch)
        if (volumes[root] < min_volume && largest[mesh.regions[root]] != root)
            new_region[root] = std::ranges::max_element(regions, {}, [](const auto& region) {
                                   return region.second;
                               })->first;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (const auto found = new_region.find(islands.root(t)); found != new_region.end())
            mesh.regions[t] = found->second;
    return static_cast<std::int64_t>(new_region.size());
}

std::int64_t remove_crumbs(TetMesh& mesh, double min_volume) {
    const std::vector<std::int32_t> piece_of = face_components(mesh);
    std::map<std::int32_t, double> piece_volumes;
    // The largest piece that holds a region stays, however small.
    std::map<std::int32_t, std::map<std::int32_t, double>> region_volumes;
    for (std::size_t t = 0; t < piece_of.size(); ++t) {
        piece_volumes[piece_of[t]] += six_volume(mesh, t) / 6;
        region_volumes[mesh.regions[t]][piece_of[t]] += six_volume(mesh, t) / 6;
    }
    const auto volume = [](const std::pair<const std::int32_t, double>& piece) { return piece.second; };
    std::map<std::int32_t, bool> keep_piece;
    for (const auto& [piece, size] : piece_volumes) keep_piece[piece] = size >= min_volume;
    for (const auto& [region, pieces] : region_volumes)
        keep_piece[std::ranges::max_element(pieces, {}, volume)->first] = true;
    std::vector<bool> keep;
    for (const std::int32_t piece : piece_of) keep.push_back(keep_piece[piece]);
    keep_tetrahedra(mesh, keep);
    return std::ranges::count_if(keep_piece, [](const auto& piece) { return !piece.second; });
}

std::int64_t part_pinched_edges(TetMesh& mesh) {
    std::int64_t removed = 0;
    constexpr int max_rounds = 50;  // each parts all pinched edges there are, and may uncover others
    for (int round = 0; round < max_rounds; ++round) {
        const auto pinched = pinched_edges(mesh);
        if (pinched.empty()) break;
        std::vector<bool> keep(mesh.tetrahedra.size(), true);
        for (const auto& [edge, around] : pinched)
            for (const std::size_t t : smallest_fan(mesh, around)) keep[t] = false;
        removed += std::ranges::count(keep, false);
        keep_tetrahedra(mesh, keep);
        split_hinges(mesh);
    }
    return removed;
}

}  // namespace palpate::meshing
