// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>
#include <map>

#include "runtime/haptics/contact/body_pair.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Index;
using Eigen::Vector3d;

// The way out of the other body: A moves along n, B against it.
Vector3d way_out(const PairContact& contact, std::size_t body) {
    return (body == 0 ? contact.gap : -contact.gap) * contact.normal;
}

// Displacements that contacts ask of vertices; where several ask, their average counts.
class Imposed {
  public:
    explicit Imposed(const ElasticSurface& body) : body_(body) {}

    void ask(std::int32_t vertex, const Vector3d& displacement) {
        if (!body_.is_free(vertex)) return;
        Asked& asked = asked_.try_emplace(vertex).first->second;
        asked.sum += displacement;
        ++asked.count;
    }

    // The forces that hold the asked displacements: C_cc f_c = u_c (Hirota and Kaneko 2001).
    std::vector<VertexForce> forces() const {
        const auto n = static_cast<Index>(asked_.size());
        Eigen::MatrixXd C(3 * n, 3 * n);
        Eigen::VectorXd u(3 * n);
        Index i = 0;
        for (const auto& [vertex, asked] : asked_) {
            Index j = 0;
            for (const auto& other : asked_)
                C.block<3, 3>(3 * i, 3 * j++) = body_.compliance(vertex, other.first);
            u.segment<3>(3 * i++) = asked.sum / asked.count;
        }
        const Eigen::VectorXd f = C.ldlt().solve(u);
        std::vector<VertexForce> forces;
        for (const auto& [vertex, asked] : asked_)
            forces.push_back({vertex, f.segment<3>(3 * static_cast<Index>(forces.size()))});
        return forces;
    }

  private:
    struct Asked {
        Vector3d sum{0, 0, 0};
        int count = 0;
    };
    const ElasticSurface& body_;
    std::map<std::int32_t, Asked> asked_;
};

double strength(const std::vector<VertexForce>& forces, std::span<const std::int32_t> vertices) {
    Vector3d sum = Vector3d::Zero();
    for (const std::int32_t vertex : vertices) {
        const auto found = std::ranges::lower_bound(forces, vertex, {}, &VertexForce::vertex);
        if (found != forces.end() && found->vertex == vertex) sum += found->force;
    }
    return sum.norm() / static_cast<double>(vertices.size());
}

}  // namespace

PairSolution split_by_force_ratio(const BodyPair& bodies, std::span<const PairContact> contacts) {
    std::array<std::vector<PairContact>, 2> inside;  // by the body of the node
    for (const PairContact& contact : contacts)
        if (contact.gap > 0) inside[contact.node_body].push_back(contact);

    // Steps 2 and 3.
    std::array<std::vector<VertexForce>, 2> temporary;
    for (std::size_t body = 0; body < 2; ++body) {
        Imposed imposed(bodies[body]);
        for (const PairContact& contact : inside[1 - body])
            for (const std::int32_t vertex : contact.polygon) imposed.ask(vertex, way_out(contact, body));
        if (inside[1 - body].empty())
            for (const PairContact& contact : inside[body]) imposed.ask(contact.node, way_out(contact, body));
        temporary[body] = imposed.forces();
    }

    // Steps 4 and 5.
    const std::size_t giver = inside[0].empty() ? 1 : 0;  // of nodes
    const auto& places = bodies[giver].vertices();
    const auto foot_of = [&](const PairContact& contact) {  // on the giver's polygon
        Vector3d foot = Vector3d::Zero();
        for (std::size_t i = 0; i < 3; ++i)
            foot += contact.weights[static_cast<Index>(i)] * places[contact.polygon[i]];
        return foot;
    };
    Imposed of_nodes(bodies[giver]), of_polygons(bodies[1 - giver]);
    for (const PairContact& contact : inside[giver]) {
        const double polygon_force = strength(temporary[1 - giver], contact.polygon);
        const auto nearest = std::ranges::min_element(inside[1 - giver], {}, [&](const PairContact& other) {
            return (foot_of(other) - places[contact.node]).squaredNorm();
        });
        const double node_force = nearest == inside[1 - giver].end()
                                      ? strength(temporary[giver], {&contact.node, 1})
                                      : strength(temporary[giver], nearest->polygon);
        const double sum = node_force + polygon_force;
        double node_part = sum > 0 ? polygon_force / sum : 0.5;
        if (!bodies[giver].is_free(contact.node)) node_part = 0;
        if (!bodies[1 - giver].is_free(contact.polygon)) node_part = 1;
        of_nodes.ask(contact.node, node_part * way_out(contact, giver));
        for (const std::int32_t vertex : contact.polygon)
            of_polygons.ask(vertex, (1 - node_part) * way_out(contact, 1 - giver));
    }
    PairForces forces;
    forces[giver] = of_nodes.forces();
    forces[1 - giver] = of_polygons.forces();
    return solution_under(bodies, contacts, std::move(forces));
}

}  // namespace palpate::haptics
