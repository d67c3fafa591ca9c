// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/surfaces/overlaps.hpp"

#include <cmath>
#include <vector>

#include "formats/model/closure.hpp"
#include "formats/model/disjoint_sets.hpp"
#include "tools/meshing/surfaces/surfaces.hpp"

namespace palpate::meshing {
namespace {

Eigen::Vector3d centre_of(const TriangleMesh& surface, const Triangle& triangle) {
    Eigen::Vector3d sum = Eigen::Vector3d::Zero();
    for (const std::int32_t v : triangle) sum += surface.vertices[static_cast<std::size_t>(v)];
    return sum / 3;
}

// What hangs together through vertices.
std::vector<TriangleMesh> parted(const TriangleMesh& surface) {
    DisjointSets sets(surface.vertices.size());
    for (const Triangle& t : surface.triangles)
        for (const std::int32_t v : {t[1], t[2]})
            sets.join(static_cast<std::size_t>(t[0]), static_cast<std::size_t>(v));
    const std::vector<std::size_t> number = sets.numbered();
    std::vector<TriangleMesh> pieces;
    std::vector<std::size_t> piece_of(number.size(), number.size());  // none yet, by number
    std::vector<std::int32_t> vertex_in_piece(number.size(), -1);
    for (const Triangle& t : surface.triangles) {
        std::size_t& piece = piece_of[number[static_cast<std::size_t>(t[0])]];
        if (piece == number.size()) {
            piece = pieces.size();
            pieces.emplace_back();
        }
        Triangle own{};
        for (std::size_t c = 0; c < 3; ++c) {
            const auto v = static_cast<std::size_t>(t[c]);
            if (vertex_in_piece[v] < 0) {
                vertex_in_piece[v] = static_cast<std::int32_t>(pieces[piece].vertices.size());
                pieces[piece].vertices.push_back(surface.vertices[v]);
            }
            own[c] = vertex_in_piece[v];
        }
        pieces[piece].triangles.push_back(own);
    }
    return pieces;
}

}  // namespace

std::optional<Eigen::Vector3d> place_of_overlap(const TriangleMesh& boundary) {
    if (const auto cut = first_self_intersection(boundary))
        return centre_of(boundary, boundary.triangles[(*cut)[0]]);
    const std::vector<TriangleMesh> pieces = parted(boundary);
    for (const TriangleMesh& piece : pieces) {
        const Eigen::Vector3d place = centre_of(piece, piece.triangles.front());
        double around = 0;  // how often the others wind about the piece
        for (const TriangleMesh& other : pieces)
            if (&other != &piece) around += winding_number(other, place);
        if (std::lround(around) != (enclosed_volume(piece) > 0 ? 0 : 1)) return place;
    }
    return {};
}

}  // namespace palpate::meshing
