// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/surface_repair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <fmt/format.h>
#include <map>
#include <vector>

#include "formats/model/disjoint_sets.hpp"
#include "formats/model/errors.hpp"
#include "tools/meshing/files/text.hpp"
#include "tools/meshing/surfaces/pieces.hpp"

namespace palpate::meshing {
namespace {

// One side of a triangle; sides of one edge are neighbours when sorted.
struct Side {
    std::int32_t low, high;
    std::size_t triangle;
    bool forwards;  // the triangle runs from low to high
    auto operator<=>(const Side&) const = default;
};

// The two sides of every edge, once it is known that there are two.
using Seams = std::vector<std::pair<Side, Side>>;

const Eigen::Vector3d& point(const TriangleMesh& surface, std::int32_t vertex) {
    return surface.vertices[vertex];
}

Eigen::Vector3d area_vector(const TriangleMesh& surface, std::size_t t) {
    const Triangle& corners = surface.triangles[t];
    const Eigen::Vector3d& a = point(surface, corners[0]);
    return 0.5 * (point(surface, corners[1]) - a).cross(point(surface, corners[2]) - a);
}

// Throws for edges that belong to one triangle or to more than two.
Seams seams_of(const TriangleMesh& surface, const std::string& culprit) {
    std::vector<Side> sides;
    sides.reserve(3 * surface.triangles.size());
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        for (std::size_t c = 0; c < 3; ++c) {
            const std::int32_t from = surface.triangles[t][c], to = surface.triangles[t][(c + 1) % 3];
            sides.push_back({std::min(from, to), std::max(from, to), t, from < to});
        }
    std::ranges::sort(sides);
    Seams seams;
    std::vector<Side> open, crowded;
    for (std::size_t i = 0; i < sides.size();) {
        std::size_t end = i + 1;
        while (end < sides.size() && sides[end].low == sides[i].low && sides[end].high == sides[i].high)
            ++end;
        if (end - i == 2) seams.emplace_back(sides[i], sides[i + 1]);
        if (end - i == 1) open.push_back(sides[i]);
        if (end - i > 2) crowded.push_back(sides[i]);
        i = end;
    }
    const auto refuse = [&](const std::vector<Side>& edges, const char* what, const char* expected,
                            const char* next_step) {
        if (edges.empty()) return;
        const Eigen::Vector3d middle = (point(surface, edges[0].low) + point(surface, edges[0].high)) / 2;
        throw InvalidInput(
            {culprit,
             fmt::format("the surface has {} {}, the first at {}", edges.size(), what, place_text(middle)),
             expected, next_step});
    };
    refuse(crowded, "edges of more than two triangles", "two at each edge",
           "remove inner walls and doubled triangles, or take the surface from a volume or labels");
    refuse(open, "open edges", "none, a closed surface",
           "close its holes where it was made, or take the surface from a volume or labels");
    return seams;
}

// Gives every triangle the side that the larger part of its piece has; returns how many were turned.
std::int64_t orient(TriangleMesh& surface, const Seams& seams, const std::string& culprit) {
    struct Link {
        std::size_t triangle;
        bool turned;
    };
    std::vector<std::vector<Link>> links(surface.triangles.size());
    for (const auto& [a, b] : seams) {
        links[a.triangle].push_back({b.triangle, a.forwards == b.forwards});
        links[b.triangle].push_back({a.triangle, a.forwards == b.forwards});
    }
    enum : signed char { unseen = -1, kept = 0, turned = 1 };
    std::vector<signed char> side(surface.triangles.size(), unseen);
    std::int64_t count = 0;
    for (std::size_t seed = 0; seed < side.size(); ++seed) {
        if (side[seed] != unseen) continue;
        side[seed] = kept;
        std::vector<std::size_t> piece{seed};
        for (std::size_t i = 0; i < piece.size(); ++i)
            for (const Link& link : links[piece[i]]) {
                const auto wanted = static_cast<signed char>(side[piece[i]] ^ static_cast<int>(link.turned));
                if (side[link.triangle] == unseen) {
                    side[link.triangle] = wanted;
                    piece.push_back(link.triangle);
                } else if (side[link.triangle] != wanted) {
                    const Eigen::Vector3d& p = point(surface, surface.triangles[link.triangle][0]);
                    throw InvalidInput({culprit, "the surface has one side only, near " + place_text(p),
                                        "an inside and an outside",
                                        "mend it where it was made, or take the surface from labels"});
                }
            }
        double area_turned = 0, area_kept = 0;
        for (const std::size_t t : piece)
            (side[t] == turned ? area_turned : area_kept) += area_vector(surface, t).norm();
        for (const std::size_t t : piece) {
            if ((side[t] == turned) == (area_turned > area_kept)) continue;
            std::swap(surface.triangles[t][1], surface.triangles[t][2]);
            ++count;
        }
    }
    return count;
}

// Gives each fan of triangles around a vertex a vertex of its own; returns how many were added.
std::int64_t part_fans(TriangleMesh& surface, const Seams& seams) {
    const auto corner_at = [&](std::size_t t, std::int32_t vertex) {
        const auto& corners = surface.triangles[t];
        return 3 * t + static_cast<std::size_t>(std::ranges::find(corners, vertex) - corners.begin());
    };
    DisjointSets fans(3 * surface.triangles.size());
    for (const auto& [a, b] : seams)
        for (const std::int32_t vertex : {a.low, a.high})
            fans.join(corner_at(a.triangle, vertex), corner_at(b.triangle, vertex));
    std::vector<bool> taken(surface.vertices.size(), false);
    std::map<std::size_t, std::int32_t> added;  // by root corner
    for (std::size_t corner = 0; corner < 3 * surface.triangles.size(); ++corner) {
        std::int32_t& vertex = surface.triangles[corner / 3][corner % 3];
        const std::size_t root = fans.root(corner);
        if (root == corner && taken[vertex]) {
            added[root] = static_cast<std::int32_t>(surface.vertices.size());
            surface.vertices.push_back(surface.vertices[vertex]);
        } else if (root == corner) {
            taken[vertex] = true;
        }
        if (const auto own = added.find(root); own != added.end()) vertex = own->second;
    }
    return static_cast<std::int64_t>(added.size());
}

// Turns pieces that face inwards though no other piece's box holds them, which no cavity does; returns how
// many triangles that took.
std::int64_t turn_inverted_pieces(TriangleMesh& surface) {
    DisjointSets sets = pieces_of(surface);
    struct Piece {
        double volume = 0;
        Eigen::AlignedBox3d box;
        bool turned = false;
    };
    std::map<std::size_t, Piece> pieces;
    const auto piece_of = [&](const Triangle& t) -> Piece& {
        return pieces[sets.root(static_cast<std::size_t>(t[0]))];
    };
    for (std::size_t t = 0; t < surface.triangles.size(); ++t) {
        Piece& piece = piece_of(surface.triangles[t]);
        piece.volume += area_vector(surface, t).dot(point(surface, surface.triangles[t][0])) / 3;
        for (const std::int32_t v : surface.triangles[t]) piece.box.extend(point(surface, v));
    }
    for (auto& [root, piece] : pieces) {
        const auto holds = [&](const auto& other) {
            return &other.second != &piece && other.second.box.contains(piece.box);
        };
        piece.turned = piece.volume < 0 && std::ranges::none_of(pieces, holds);
    }
    std::int64_t count = 0;
    for (Triangle& t : surface.triangles)
        if (piece_of(t).turned) {
            std::swap(t[1], t[2]);
            ++count;
        }
    return count;
}

std::int64_t drop_unused_vertices(TriangleMesh& surface) {
    std::vector<std::int32_t> index(surface.vertices.size(), -1);
    for (const Triangle& t : surface.triangles)
        for (const std::int32_t v : t) index[v] = 0;
    std::size_t used = 0;
    for (std::size_t v = 0; v < index.size(); ++v) {
        if (index[v] < 0) continue;
        surface.vertices[used] = surface.vertices[v];
        index[v] = static_cast<std::int32_t>(used++);
    }
    surface.vertices.resize(used);
    for (Triangle& t : surface.triangles)
        for (std::int32_t& v : t) v = index[v];
    return static_cast<std::int64_t>(index.size() - used);
}

}  // namespace

TriangleMesh repaired_surface(TriangleMesh surface, const std::string& culprit,
                              const std::function<void(std::string_view)>& note) {
    const auto say = [&](std::int64_t count, const char* what) {
        if (count > 0 && note) note(fmt::format("{}: {} {}", culprit, count, what));
    };
    say(static_cast<std::int64_t>(
            std::erase_if(surface.triangles,
                          [](const Triangle& t) { return t[0] == t[1] || t[1] == t[2] || t[2] == t[0]; })),
        "triangles with a repeated vertex left out");
    if (surface.triangles.empty())
        throw InvalidInput({culprit, "holds no triangles", "a closed surface", "check how it was made"});
    say(drop_unused_vertices(surface), "unused or doubled vertices left out");
    for (std::size_t t = 0; t < surface.triangles.size(); ++t)
        if (!(area_vector(surface, t).norm() > 0))
            throw InvalidInput({culprit,
                                fmt::format("triangle {} has no area, at {}", t,
                                            place_text(point(surface, surface.triangles[t][0]))),
                                "triangles with an area",
                                "clean it where it was made, for example 'Remove degenerate faces'"});
    const Seams seams = seams_of(surface, culprit);
    say(orient(surface, seams, culprit), "triangles turned to the side of their neighbours");
    say(part_fans(surface, seams), "vertices doubled where pieces touch in a point");
    say(turn_inverted_pieces(surface), "triangles turned: their piece faced inwards");
    return surface;
}

void require_sound_surface(const TriangleMesh& surface, const std::string& culprit) {
    std::string repairs;
    repaired_surface(surface, culprit, [&](std::string_view note) {
        repairs += repairs.empty() ? "" : ", ";
        repairs += note.substr(culprit.size() + 2);  // behind the culprit's name
    });
    if (!repairs.empty())
        throw InvalidInput({culprit, "needs repair: " + repairs, "closed, all triangles facing outwards",
                            "mend it by 'palpate surface --surface-file'"});
}

}  // namespace palpate::meshing
