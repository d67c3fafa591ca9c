// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/load_spread.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <utility>

// A point force on a mesh of tetrahedra meets the mesh's compliance, which grows as 1 / h and changes with
// the place between nodes, not the tissue's. So a contact's force f is spread over a disc of radius R of some
// elements, with the density
//     k(rho) = 3 / (pi R²) (1 - rho² / R²)²,
// and the displacement there averaged with the same density: C becomes S C S', S_vj the share of vertex j in
// the disc about vertex v. Any mesh gets that compliance right, for it is smooth on the mesh's scale. What a
// sphere sinks into the tissue besides stands in local_indentation.cpp.

namespace palpate::haptics {
namespace {

using Eigen::Matrix3f;
using Eigen::Vector3d;

// R, in edges' lengths: of those that a quarter are shorter than, so that a refined place decides.
constexpr double elements_in_radius = 2.5;
constexpr double same_side = 0.3;    // cosine between normals that a disc takes together
constexpr double near_in_radii = 2;  // beyond it, spread forces act like point forces

struct Edges {
    std::vector<std::size_t> first;
    std::vector<std::int32_t> to;
    std::span<const std::int32_t> of(std::size_t v) const {
        return std::span(to).subspan(first[v], first[v + 1] - first[v]);
    }
};

Edges edges_of(const TriangleMesh& mesh) {
    std::vector<std::vector<std::int32_t>> lists(mesh.vertices.size());
    for (const Triangle& t : mesh.triangles)
        for (std::size_t corner = 0; corner < 3; ++corner) {
            lists[static_cast<std::size_t>(t[corner])].push_back(t[(corner + 1) % 3]);
            lists[static_cast<std::size_t>(t[corner])].push_back(t[(corner + 2) % 3]);
        }
    Edges edges;
    edges.first.push_back(0);
    for (auto& list : lists) {
        std::ranges::sort(list);
        list.erase(std::unique(list.begin(), list.end()), list.end());
        edges.to.insert(edges.to.end(), list.begin(), list.end());
        edges.first.push_back(edges.to.size());
    }
    return edges;
}

// E / (1 - nu²) of the tetrahedra that have a contact node: the mean of their compliances; 0 if no material
// is known.
double modulus_at_surface(const DeformableBody& body) {
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

// Of each vertex: a third of the area of its triangles, mm², and their mean normal, unit.
struct VertexShapes {
    std::vector<double> areas;
    std::vector<Vector3d> normals;
};

VertexShapes vertex_shapes(const TriangleMesh& mesh) {
    VertexShapes shapes{std::vector<double>(mesh.vertices.size(), 0),
                        std::vector<Vector3d>(mesh.vertices.size(), Vector3d::Zero())};
    for (const Triangle& t : mesh.triangles) {
        const auto at = [&](std::size_t corner) {
            return mesh.vertices[static_cast<std::size_t>(t[corner])];
        };
        const Vector3d third = (at(1) - at(0)).cross(at(2) - at(0)) / 6;
        for (const std::int32_t v : t) {
            shapes.areas[static_cast<std::size_t>(v)] += third.norm();
            shapes.normals[static_cast<std::size_t>(v)] += third;
        }
    }
    for (Vector3d& normal : shapes.normals) normal.normalize();
    return shapes;
}

// The vertices that a walk over the surface reaches within a ball about the first, which comes first.
class Walk {
  public:
    explicit Walk(const TriangleMesh& mesh)
        : mesh_(mesh), edges_(edges_of(mesh)), seen_(mesh.vertices.size(), 0) {}

    template <typename Take>
    const std::vector<std::int32_t>& within(std::int32_t from, double radius, const Take& takes) {
        ++walk_;
        found_.assign(1, from);
        seen_[static_cast<std::size_t>(from)] = walk_;
        const Vector3d centre = mesh_.vertices[static_cast<std::size_t>(from)];
        for (std::size_t next = 0; next < found_.size(); ++next)
            for (const std::int32_t v : edges_.of(static_cast<std::size_t>(found_[next]))) {
                std::int32_t& seen = seen_[static_cast<std::size_t>(v)];
                if (seen == walk_ ||
                    (mesh_.vertices[static_cast<std::size_t>(v)] - centre).norm() >= radius || !takes(v))
                    continue;
                seen = walk_;
                found_.push_back(v);
            }
        return found_;
    }
    const std::vector<std::int32_t>& within(std::int32_t from, double radius) {
        return within(from, radius, [](std::int32_t) { return true; });
    }

  private:
    const TriangleMesh& mesh_;
    Edges edges_;
    std::vector<std::int32_t> seen_, found_;
    std::int32_t walk_ = 0;
};

}  // namespace

LoadSpread::LoadSpread(const DeformableBody& body, std::span<const std::int32_t> blocks) {
    const double edge = short_edge(body.boundary.surface, blocks), reach = elements_in_radius * edge;
    // Between vertices, displacements are linear, which spreads them a little more.
    radius_ = std::hypot(reach, edge);
    contact_modulus_ = modulus_at_surface(body);
    add_shares(body, blocks, reach);
    add_near(body, blocks, reach);
}

void LoadSpread::add_shares(const DeformableBody& body, std::span<const std::int32_t> blocks, double reach) {
    const TriangleMesh& mesh = body.boundary.surface;
    const auto [areas, normals] = vertex_shapes(mesh);
    Walk walk(mesh);
    first_share_.push_back(0);
    for (std::size_t v = 0; v < mesh.vertices.size(); ++v) {
        const auto same = [&](std::int32_t other) {
            return normals[static_cast<std::size_t>(other)].dot(normals[v]) > same_side;
        };
        double sum = 0, free = 0;
        const std::size_t first = shares_.size();
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
                free += weight;
                shares_.push_back({other, static_cast<float>(weight)});
            }
        for (std::size_t k = first; k < shares_.size(); ++k) shares_[k].weight /= static_cast<float>(sum);
        freedom_.push_back(sum > 0 ? static_cast<float>(free / sum) : 0);
        first_share_.push_back(shares_.size());
    }
}

void LoadSpread::add_near(const DeformableBody& body, std::span<const std::int32_t> blocks, double reach) {
    const auto count = static_cast<std::int32_t>(body.boundary.surface.vertices.size());
    const auto block_of = [&](std::int32_t vertex) { return blocks[static_cast<std::size_t>(vertex)]; };
    Walk walk(body.boundary.surface);
    std::vector<Matrix3f> moved(blocks.size());  // by vertex: S C of vertex a, where it is computed
    std::vector<std::int32_t> computed(blocks.size(), -1);
    first_near_.push_back(0);
    for (std::int32_t a = 0; a < count; ++a) {
        std::vector<std::int32_t> near = walk.within(a, near_in_radii * reach);
        std::erase_if(near, [&](std::int32_t b) { return b < a; });
        std::ranges::sort(near);
        for (const std::int32_t b : near) {
            Matrix3f sum = Matrix3f::Zero();
            for (const Share& there : shares(b)) {
                const auto j = static_cast<std::size_t>(there.vertex);
                if (computed[j] != a) {
                    computed[j] = a;
                    moved[j].setZero();
                    for (const Share& here : shares(a))
                        moved[j] += here.weight * compliance_block(body.compliance, block_of(here.vertex),
                                                                   block_of(there.vertex));
                }
                sum += there.weight * moved[j];
            }
            near_.push_back(b);
            near_blocks_.push_back(sum);
        }
        first_near_.push_back(near_.size());
    }
}

}  // namespace palpate::haptics
