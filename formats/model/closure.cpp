// SPDX-License-Identifier: Apache-2.0
#include "formats/model/closure.hpp"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numbers>
#include <random>
#include <utility>

namespace palpate {
namespace {

std::uint64_t drawn() {
    std::random_device device;
    return std::uint64_t{device()} << 32 | device();
}

// The finaliser of SplitMix64 (Steele, Lea, Flood 2014): each bit of the result depends on each of `bits`.
constexpr std::uint64_t mixed(std::uint64_t bits) {
    bits = (bits ^ (bits >> 30)) * 0xBF58476D1CE4E5B9U;
    bits = (bits ^ (bits >> 27)) * 0x94D049BB133111EBU;
    return bits ^ (bits >> 31);
}

// A number for some indices in ascending order, the same within a program.
template <typename... Indices>
std::uint64_t number_of(Indices... indices) {
    static const std::uint64_t key = drawn();
    std::uint64_t number = key;
    ((number = mixed(number + static_cast<std::uint32_t>(indices))), ...);
    return number;
}

// Its number, negated where the corners' order is an odd permutation of the ascending one.
std::uint64_t signed_number(Triangle face) {
    bool odd = false;
    for (const auto& [a, b] : {std::pair(0, 1), std::pair(1, 2), std::pair(0, 1)})
        if (face[a] > face[b]) {
            std::swap(face[a], face[b]);
            odd = !odd;
        }
    const std::uint64_t number = number_of(face[0], face[1], face[2]);
    return odd ? -number : number;
}

}  // namespace

bool edges_cancel(const TriangleMesh& surface) {
    std::uint64_t sum = 0;
    for (const Triangle& triangle : surface.triangles)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const std::int32_t from = triangle[corner], to = triangle[(corner + 1) % 3];
            sum += from < to ? number_of(from, to) : -number_of(to, from);
        }
    return sum == 0;
}

bool faces_cancel(const TetMesh& mesh, const BoundarySurface& boundary) {
    std::uint64_t sum = 0;
    for (const Tetrahedron& tet : mesh.tetrahedra)
        for (const auto& face : tetrahedron_faces)
            sum += signed_number({tet[face[0]], tet[face[1]], tet[face[2]]});
    for (const Triangle& triangle : boundary.surface.triangles) {
        const auto node = [&](std::size_t corner) {
            return boundary.nodes[static_cast<std::size_t>(triangle[corner])];
        };
        sum -= signed_number({node(0), node(1), node(2)});
    }
    return sum == 0;
}

double enclosed_volume(const TriangleMesh& surface) {
    double six_volumes = 0;
    for (const Triangle& triangle : surface.triangles) {
        // From a corner of the surface, so that nothing is lost far from the origin.
        const auto from_first = [&](std::size_t corner) {
            return surface.vertices[static_cast<std::size_t>(triangle[corner])] - surface.vertices[0];
        };
        six_volumes += from_first(0).dot(from_first(1).cross(from_first(2)));
    }
    return six_volumes / 6;
}

double winding_number(const TriangleMesh& surface, const Eigen::Vector3d& p) {
    double solid_angle = 0;
    for (const Triangle& triangle : surface.triangles) {
        const auto from_p = [&](std::size_t corner) -> Eigen::Vector3d {
            return surface.vertices[static_cast<std::size_t>(triangle[corner])] - p;
        };
        const Eigen::Vector3d a = from_p(0), b = from_p(1), c = from_p(2);
        const double la = a.norm(), lb = b.norm(), lc = c.norm();
        solid_angle +=
            2 * std::atan2(a.dot(b.cross(c)), la * lb * lc + a.dot(b) * lc + b.dot(c) * la + c.dot(a) * lb);
    }
    return solid_angle / (4 * std::numbers::pi);
}

}  // namespace palpate
