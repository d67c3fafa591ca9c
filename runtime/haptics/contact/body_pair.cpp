// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/body_pair.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <limits>
#include <map>
#include <memory>
#include <numeric>
#include <utility>

#include "formats/model/contact/compliance_blocks.hpp"
#include "formats/model/errors.hpp"
#include "runtime/haptics/contact/contact_lcp.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

constexpr double touching = 1e-9;  // mm: nearer to a polygon than this, a node gives no direction

struct WeightedVertex {
    std::int32_t vertex;
    double weight;
};

// What a contact takes hold of on one of the bodies.
struct Grip {
    std::array<WeightedVertex, 3> vertices;
    std::size_t count;

    auto begin() const { return vertices.begin(); }
    auto end() const { return vertices.begin() + static_cast<std::ptrdiff_t>(count); }
};

Grip grip_of(const PairContact& contact, std::size_t body) {
    if (body == contact.node_body) return {{{{contact.node, 1}, {}, {}}}, 1};
    return {{{{contact.polygon[0], contact.weights[0]},
              {contact.polygon[1], contact.weights[1]},
              {contact.polygon[2], contact.weights[2]}}},
            3};
}

Vector3d displacement_of(const ElasticSurface& body, std::int32_t vertex,
                         std::span<const VertexForce> loads) {
    Vector3d displacement = Vector3d::Zero();
    for (const VertexForce& load : loads) displacement += body.compliance(vertex, load.vertex) * load.force;
    return displacement;
}

Vector3d normal_of(const ElasticSurface& body, const Triangle& t) {
    const auto corner = [&](std::size_t i) { return body.vertices()[t[i]]; };
    return (corner(1) - corner(0)).cross(corner(2) - corner(0)).normalized();
}

// Appends the contacts of the nodes of `node_body`, whose vertices lie at `shift` in the other's frame.
void find_nodes(const BodyPair& bodies, std::size_t node_body, const Vector3d& shift, double margin,
                std::vector<PairContact>& contacts) {
    const ElasticSurface &nodes = bodies[node_body], &polygons = bodies[1 - node_body];
    Eigen::AlignedBox3d box;
    for (const Vector3d& vertex : polygons.vertices()) box.extend(vertex);
    for (std::size_t v = 0; v < nodes.vertices().size(); ++v) {
        const Vector3d p = nodes.vertices()[v] + shift;
        if (box.exteriorDistance(p) > margin) continue;
        const bool outside = polygons.collision().is_outside(p);
        const auto nearest =
            polygons.collision().closest_point(p, outside ? margin : std::numeric_limits<double>::infinity());
        if (!nearest) continue;
        PairContact contact{.node_body = node_body,
                            .node = static_cast<std::int32_t>(v),
                            .polygon = polygons.triangles()[nearest->triangle],
                            .weights = nearest->barycentric};
        if (!nodes.is_free(contact.node) && !polygons.is_free(contact.polygon)) continue;
        Vector3d outwards = normal_of(polygons, contact.polygon);
        if (nearest->distance > touching)
            outwards = (outside ? p - nearest->point : nearest->point - p) / nearest->distance;
        contact.normal = node_body == 0 ? outwards : -outwards;
        contact.gap = outside ? -nearest->distance : nearest->distance;
        contacts.push_back(contact);
    }
}

// A_kl of the contacts, mm/N.
Eigen::MatrixXd contact_compliance(const BodyPair& bodies, std::span<const PairContact> contacts) {
    const auto n = static_cast<Index>(contacts.size());
    Eigen::MatrixXd A = Eigen::MatrixXd::Zero(n, n);
    for (Index k = 0; k < n; ++k)
        for (Index l = 0; l <= k; ++l) {
            const PairContact &a = contacts[k], &b = contacts[l];
            for (std::size_t body = 0; body < 2; ++body)
                for (const WeightedVertex& i : grip_of(a, body))
                    for (const WeightedVertex& j : grip_of(b, body))
                        A(k, l) += i.weight * j.weight *
                                   a.normal.dot(bodies[body].compliance(i.vertex, j.vertex) * b.normal);
            A(l, k) = A(k, l);
        }
    return A;
}

// Solves f >= 0, w = A f - delta >= 0, f . w = 0. ContactLcp takes so many rows at a time: those it gets are
// exchanged, idle for violated, until none is violated. Each exchange lowers f.Af/2 - delta.f, so that ends.
Eigen::VectorXd complementary_forces(const Eigen::MatrixXd& A, const Eigen::VectorXd& delta) {
    std::vector<Index> rows(static_cast<std::size_t>(delta.size()));
    std::iota(rows.begin(), rows.end(), Index{0});
    std::ranges::stable_sort(rows, std::greater{}, [&](Index row) { return delta[row]; });
    rows.resize(std::min(rows.size(), max_contacts));
    const auto lcp = std::make_unique<ContactLcp>();
    const auto count = static_cast<Index>(rows.size());
    Eigen::VectorXd f;
    for (Index round = 0; round <= delta.size(); ++round) {
        lcp->matrix().topLeftCorner(count, count) = A(rows, rows);
        lcp->gaps().head(count) = delta(rows);
        lcp->solve(rows.size(), {});
        f = Eigen::VectorXd::Zero(delta.size());
        f(rows) = lcp->forces().head(count);
        if (count == delta.size()) return f;

        const Eigen::VectorXd w = A * f - delta;
        Eigen::VectorXd outside = w;
        outside(rows).setZero();
        Index worst = 0;
        outside.minCoeff(&worst);
        const auto most_idle =
            std::ranges::max_element(rows, {}, [&](Index row) { return f[row] > 0 ? -1 : w[row]; });
        if (outside[worst] >= -ContactLcp::tolerance || !(w[*most_idle] > 0) || f[*most_idle] > 0) return f;
        *most_idle = worst;
    }
    return f;
}

}  // namespace

ElasticSurface::ElasticSurface(const DeformableBody& body)
    : surface_(body.boundary.surface),
      collision_(surface_, body.obb_tree, body.name),
      compliance_(body.compliance) {
    blocks_ = compliance_blocks(body);
}

bool ElasticSurface::is_free(const Triangle& polygon) const noexcept {
    return std::ranges::any_of(polygon, [&](std::int32_t vertex) { return is_free(vertex); });
}

Eigen::Matrix3d ElasticSurface::compliance(std::int32_t a, std::int32_t b) const noexcept {
    if (!is_free(a) || !is_free(b)) return Eigen::Matrix3d::Zero();
    return compliance_block(compliance_, blocks_[a], blocks_[b]).cast<double>();
}

std::vector<PairContact> find_contacts(const BodyPair& bodies, const Vector3d& offset, double margin) {
    std::vector<PairContact> contacts;
    find_nodes(bodies, 0, -offset, margin, contacts);
    find_nodes(bodies, 1, offset, margin, contacts);
    return contacts;
}

PairSolution solution_under(const BodyPair& bodies, std::span<const PairContact> contacts,
                            PairForces forces) {
    PairSolution solution{.forces = std::move(forces), .displacements = {}, .distances = {}};
    for (std::size_t body = 0; body < 2; ++body)
        for (const VertexForce& load : solution.forces[body])
            solution.energy +=
                load.force.dot(displacement_of(bodies[body], load.vertex, solution.forces[body])) / 2;
    for (const PairContact& contact : contacts) {
        std::array<Vector3d, 2> u{Vector3d::Zero(), Vector3d::Zero()};
        for (std::size_t body = 0; body < 2; ++body)
            for (const WeightedVertex& i : grip_of(contact, body))
                u[body] += i.weight * displacement_of(bodies[body], i.vertex, solution.forces[body]);
        solution.displacements.push_back(u);
        solution.distances.push_back(contact.normal.dot(u[0] - u[1]) - contact.gap);
    }
    return solution;
}

PairSolution solve_exactly(const BodyPair& bodies, std::span<const PairContact> contacts) {
    if (contacts.empty()) return {};
    Eigen::VectorXd delta(static_cast<Index>(contacts.size()));
    std::ranges::transform(contacts, delta.begin(), &PairContact::gap);
    const Eigen::VectorXd f = complementary_forces(contact_compliance(bodies, contacts), delta);

    PairForces forces;
    for (std::size_t body = 0; body < 2; ++body) {
        std::map<std::int32_t, Vector3d> sums;
        for (std::size_t k = 0; k < contacts.size(); ++k) {
            const double force = f[static_cast<Index>(k)];
            if (!(force > 0)) continue;
            for (const WeightedVertex& i : grip_of(contacts[k], body))
                sums.try_emplace(i.vertex, Vector3d::Zero()).first->second +=
                    (body == 0 ? force : -force) * i.weight * contacts[k].normal;
        }
        for (const auto& [vertex, force] : sums) forces[body].push_back({vertex, force});
    }
    return solution_under(bodies, contacts, std::move(forces));
}

}  // namespace palpate::haptics
