// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/load_spread.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <set>
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
    const std::set<std::int32_t> contact_nodes(body.contact_nodes.begin(), body.contact_nodes.end());
    double compliance = 0;
    std::size_t count = 0;
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
        const auto material =
            std::ranges::find(body.materials, body.mesh.regions[t], &RegionMaterial::region);
        const bool at_surface = std::ranges::any_of(
            body.mesh.tetrahedra[t], [&](std::int32_t node) { return contact_nodes.contains(node); });
        if (!at_surface || material == body.materials.end()) continue;
        const auto [youngs_modulus, poissons_ratio] = material->material;
        compliance += (1 - poissons_ratio * poissons_ratio) / youngs_modulus;
        ++count;
    }
    return count > 0 ? static_cast<double>(count) / compliance : 0;
}

// The vertices that a walk over the surface reaches within a ball about the first, which comes first.
class Walk {
  public:
    Walk(const TriangleMesh& mesh, const Edges& edges)
        : mesh_(mesh), edges_(edges), seen_(mesh.vertices.size(), 0) {}

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
    const Edges& edges_;
    std::vector<std::int32_t> seen_, found_;
    std::int32_t walk_ = 0;
};

}  // namespace

LoadSpread::LoadSpread(const DeformableBody& body, std::span<const std::int32_t> blocks) {
    const TriangleMesh& mesh = body.boundary.surface;
    const std::size_t count = mesh.vertices.size();
    std::vector<double> areas(count, 0);
    std::vector<Vector3d> normals(count, Vector3d::Zero());
    std::vector<double> lengths;
    for (const Triangle& t : mesh.triangles) {
        const auto at = [&](std::size_t corner) {
            return mesh.vertices[static_cast<std::size_t>(t[corner])];
        };
        const Vector3d area = (at(1) - at(0)).cross(at(2) - at(0)) / 2;
        bool touchable = true;
        for (std::size_t corner = 0; corner < 3; ++corner) {
            const auto v = static_cast<std::size_t>(t[corner]);
            areas[v] += area.norm() / 3;
            normals[v] += area;
            touchable = touchable && blocks[v] >= 0;
        }
        for (std::size_t corner = 0; touchable && corner < 3; ++corner)
            lengths.push_back((at(corner) - at((corner + 1) % 3)).norm());
    }
    for (Vector3d& normal : normals) normal.normalize();
    double length = 0;
    if (!lengths.empty()) {
        const auto quarter = lengths.begin() + static_cast<std::ptrdiff_t>(lengths.size() / 4);
        std::ranges::nth_element(lengths, quarter);
        length = *quarter;
    }
    const double reach = elements_in_radius * length;
    // Between vertices, displacements are linear, which spreads them a little more.
    radius_ = std::hypot(reach, length);
    contact_modulus_ = modulus_at_surface(body);

    const std::set<std::int32_t> fixed_nodes(body.fixed_nodes.begin(), body.fixed_nodes.end());
    const Edges edges = edges_of(mesh);
    Walk walk(mesh, edges);
    first_share_.push_back(0);
    for (std::size_t v = 0; v < count; ++v) {
        if (blocks[v] < 0) {  // what does not give way does not spread either
            freedom_.push_back(0);
            first_share_.push_back(shares_.size());
            continue;
        }
        const auto same = [&](std::int32_t other) {
            return normals[static_cast<std::size_t>(other)].dot(normals[v]) > same_side;
        };
        double sum = 0, free = 0;
        const std::size_t first = shares_.size();
        for (const std::int32_t other : walk.within(static_cast<std::int32_t>(v), reach, same)) {
            const auto j = static_cast<std::size_t>(other);
            const double rho = (mesh.vertices[j] - mesh.vertices[v]).norm() / std::max(reach, 1e-12);
            const double weight = areas[j] * std::pow(1 - rho * rho, 2);
            const bool gives_way = blocks[j] >= 0;
            if (gives_way || fixed_nodes.contains(body.boundary.nodes[j])) sum += weight;
            if (!gives_way) continue;
            free += weight;
            shares_.push_back({other, static_cast<float>(weight)});
        }
        for (std::size_t k = first; k < shares_.size(); ++k) shares_[k].weight /= static_cast<float>(sum);
        freedom_.push_back(static_cast<float>(free / sum));
        first_share_.push_back(shares_.size());
    }

    std::vector<Matrix3f> moved(count);
    std::vector<std::int32_t> computed(count, -1);
    first_near_.push_back(0);
    std::vector<std::pair<std::int32_t, Matrix3f>> row;
    for (std::size_t a = 0; a < count; ++a) {
        row.clear();
        for (const std::int32_t b : walk.within(static_cast<std::int32_t>(a), near_in_radii * reach)) {
            Matrix3f sum = Matrix3f::Zero();
            for (const Share& there : shares(b)) {
                const auto j = static_cast<std::size_t>(there.vertex);
                if (computed[j] != static_cast<std::int32_t>(a)) {
                    computed[j] = static_cast<std::int32_t>(a);
                    moved[j].setZero();
                    for (const Share& here : shares(static_cast<std::int32_t>(a)))
                        moved[j] +=
                            here.weight * compliance_block(body.compliance,
                                                           blocks[static_cast<std::size_t>(here.vertex)],
                                                           blocks[j]);
                }
                sum += there.weight * moved[j];
            }
            row.emplace_back(b, sum);
        }
        std::ranges::sort(row, {}, [](const auto& entry) { return entry.first; });
        for (const auto& [b, block] : row) {
            near_.push_back(b);
            near_blocks_.push_back(block);
        }
        first_near_.push_back(near_.size());
    }
}

}  // namespace palpate::haptics
