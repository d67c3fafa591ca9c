// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/fem/certificate/linear_limits.hpp"

#include <Eigen/Eigenvalues>
#include <Eigen/Geometry>
#include <algorithm>
#include <cmath>
#include <iterator>
#include <limits>
#include <numeric>
#include <optional>
#include <random>
#include <utility>
#include <vector>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/shape_gradients.hpp"
#include "formats/hyperelasticity/equilibrium.hpp"
#include "formats/model/errors.hpp"
#include "tools/fem/certificate/contact_loads.hpp"

namespace palpate::fem {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Eigen::VectorXd;
using hyperelasticity::Equilibrium;

constexpr double most_poissons_ratio = 0.4999;  // beyond it Equilibrium's steps get too short
constexpr double settled = 3e-4;                // of the way that the linear answer goes
constexpr int most_steps = 100;                 // of Equilibrium, which needs 60 at a ratio of 0.499
constexpr int most_attempts = 12;               // at the force that strains as far as is asked
constexpr double strain_close = 0.03;           // relative

double radius_of(const DeformableBody& body) {
    double six_volumes = 0, area = 0;
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) six_volumes += six_volume(body.mesh, t);
    const auto& [positions, triangles] = body.boundary.surface;
    for (const Triangle& t : triangles)
        area += (positions[t[1]] - positions[t[0]]).cross(positions[t[2]] - positions[t[0]]).norm() / 2;
    return std::max(0.1 * std::cbrt(six_volumes / 6),
                    std::sqrt(area / static_cast<double>(body.boundary.nodes.size())));
}

// Contact nodes that are farther than that from every held node; all of them where none is.
std::vector<std::int32_t> centers_of(const DeformableBody& body, double radius) {
    std::vector<std::int32_t> all(body.contact_nodes.size());
    std::iota(all.begin(), all.end(), 0);
    std::vector<std::int32_t> free;
    std::ranges::copy_if(all, std::back_inserter(free), [&](std::int32_t contact) {
        return std::ranges::none_of(body.fixed_nodes, [&](std::int32_t node) {
            return (body.mesh.rest_positions[node] - body.mesh.rest_positions[body.contact_nodes[contact]])
                       .squaredNorm() < radius * radius;
        });
    });
    return free.empty() ? all : free;
}

// A force of 1 N along `direction` around a contact node.
ContactLoad load_at(const DeformableBody& body, std::int32_t center, const Vector3d& direction,
                    double radius) {
    const auto point = [&](std::int32_t contact) {
        return body.mesh.rest_positions[body.contact_nodes[contact]];
    };
    ContactLoad load;
    double sum = 0;
    const auto share = [&](std::int32_t contact) {
        return 1 - (point(contact) - point(center)).squaredNorm() / (radius * radius);
    };
    const auto count = static_cast<std::int32_t>(body.contact_nodes.size());
    for (std::int32_t contact = 0; contact < count; ++contact) sum += std::max(0.0, share(contact));
    for (std::int32_t contact = 0; contact < count; ++contact)
        if (share(contact) > 0) load.push_back({contact, (share(contact) / sum * direction).cast<float>()});
    return load;
}

// The tissue and where its contact nodes are among the free ones.
class Tissue {
  public:
    explicit Tissue(const DeformableBody& body) : body_(body), equilibrium_(body) {}

    void rest() { equilibrium_.reset(); }

    // False if no rest was found under `scale` of the load; `way`: how far that goes, mm, about.
    bool press(const ContactLoad& load, double scale, double way) {
        VectorXd forces = VectorXd::Zero(equilibrium_.mesh().dofs());
        for (const NodeForce& force : load)
            forces.segment<3>(3 * position(force.node)) = scale * force.force.cast<double>();
        return equilibrium_.approach(forces, settled * way, most_steps) <= settled * way;
    }

    // Of x, y, z of every contact node, mm.
    VectorXd surface() const {
        VectorXd u(static_cast<Index>(3 * body_.contact_nodes.size()));
        for (std::int32_t contact = 0; contact < u.size() / 3; ++contact)
            u.segment<3>(3 * Index{contact}) = equilibrium_.displacements().segment<3>(3 * position(contact));
        return u;
    }

    double largest_strain() const {
        double largest = 0;
        for (std::size_t t = 0; t < body_.mesh.tetrahedra.size(); ++t) {
            const auto& nodes = body_.mesh.tetrahedra[t];
            const auto shape = elasticity::shape_of(elasticity::corners_of(body_.mesh, t));
            Eigen::Matrix3d gradient = Eigen::Matrix3d::Identity();
            for (Index c = 0; c < 4; ++c)
                if (const Index at = equilibrium_.mesh().positions()[nodes[c]]; at >= 0)
                    gradient +=
                        equilibrium_.displacements().segment<3>(3 * at) * shape.gradients.col(c).transpose();
            const Vector3d squares = Eigen::SelfAdjointEigenSolver<Eigen::Matrix3d>(
                                         gradient.transpose() * gradient, Eigen::EigenvaluesOnly)
                                         .eigenvalues();
            largest = std::max({largest, std::abs(std::sqrt(std::max(0.0, squares[0])) - 1),
                                std::abs(std::sqrt(squares[2]) - 1)});
        }
        return largest;
    }

  private:
    Index position(std::int32_t contact) const {
        return equilibrium_.mesh().positions()[body_.contact_nodes[contact]];
    }

    const DeformableBody& body_;
    Equilibrium equilibrium_;
};

// Mean displacement of what is pressed along the force, weighted by it: the load's work by its force.
double way_of(const ContactLoad& load, const VectorXd& displacements) {
    double work = 0;
    Vector3d sum = Vector3d::Zero();
    for (const NodeForce& force : load) {
        work += force.force.cast<double>().dot(displacements.segment<3>(3 * Index{force.node}));
        sum += force.force.cast<double>();
    }
    return work / sum.norm();
}

double largest_node(const VectorXd& displacements) {
    double largest = 0;
    for (Index at = 0; at < displacements.size(); at += 3)
        largest = std::max(largest, displacements.segment<3>(at).norm());
    return largest;
}

// The linear answer beside the tissue's where a load strains it by `strain`; by less, where no rest was found
// on the way there.
std::optional<LinearLimits> limits_under(const DeformableBody& body, Tissue& tissue, const ContactLoad& load,
                                         double radius, double strain) {
    const VectorXd linear = displacements_of(body.compliance, load);
    const double linear_way = way_of(load, linear);  // under 1 N
    double force = strain * radius / linear_way;
    bool was_too_much = false;
    std::optional<LinearLimits> found;
    tissue.rest();
    for (int attempt = 0; attempt < most_attempts; ++attempt) {
        if (!tissue.press(load, force, force * linear_way)) {
            tissue.rest();
            was_too_much = true;
            force /= 2;
            continue;
        }
        const double reached = tissue.largest_strain();
        const VectorXd u = tissue.surface();
        const double way = way_of(load, u);
        found = {reached, way, std::abs(way / linear_way / force - 1),
                 largest_node(way / linear_way * linear - u) / largest_node(u)};
        const bool bears_no_more = was_too_much && reached < strain;
        if (bears_no_more || std::abs(reached / strain - 1) < strain_close) break;
        force *= std::clamp(strain / reached, 0.5, 2.0);
    }
    return found;
}

// None where its search does not end, takes long, or cannot begin.
std::optional<Tissue> tissue_of(const DeformableBody& body) {
    const std::size_t nodes = elasticity::discretise(body).node_count;
    if (3 * (nodes - body.fixed_nodes.size()) > linear_limit_dofs) return std::nullopt;
    if (std::ranges::any_of(body.materials, [](const RegionMaterial& region) {
            return region.material.poissons_ratio > most_poissons_ratio;
        }))
        return std::nullopt;
    try {
        return std::optional<Tissue>(std::in_place, body);
    } catch (const InvalidInput&) {
        return std::nullopt;
    }
}

}  // namespace

LinearLimits find_linear_limits(const DeformableBody& body, double strain) {
    std::optional<Tissue> tissue = tissue_of(body);
    if (!tissue) return {};
    const double radius = radius_of(body);
    const std::vector<Vector3d> normals = contact_normals(body);
    const std::vector<std::int32_t> centers = centers_of(body, radius);
    std::mt19937_64 random(linear_limit_seed);
    LinearLimits all{.strain = std::numeric_limits<double>::max(), .force_error = 0, .surface_error = 0};
    std::vector<double> depths;
    for (std::int32_t place = 0; place < linear_limit_places; ++place) {
        const std::int32_t center = centers[random() % centers.size()];
        for (const double side : {-1.0, 1.0}) {
            const ContactLoad load = load_at(body, center, side * normals[center], radius);
            const auto one = limits_under(body, *tissue, load, radius, strain);
            if (!one) return {};
            all.strain = std::min(all.strain, one->strain);
            all.force_error = std::max(all.force_error, one->force_error);
            all.surface_error = std::max(all.surface_error, one->surface_error);
            depths.push_back(one->depth);
        }
    }
    std::ranges::nth_element(depths, depths.begin() + linear_limit_places);
    all.depth = depths[linear_limit_places];
    return all;
}

void set_linear_limits(Certificate& certificate, const LinearLimits& limits) {
    certificate.checked_strain = limits.strain;
    certificate.checked_depth = limits.depth;
    certificate.linear_force_error = limits.force_error;
    certificate.linear_surface_error = limits.surface_error;
}

}  // namespace palpate::fem
