// SPDX-License-Identifier: Apache-2.0
#include "formats/elasticity/plausible_compliance.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <cmath>
#include <random>
#include <vector>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/stiffness.hpp"
#include "formats/model/errors.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Stiffness = Eigen::SparseMatrix<double>;
// Half the iterations' time of the diagonal alone.
using Gradients = Eigen::ConjugateGradient<Stiffness, Eigen::Lower, Eigen::IncompleteCholesky<double>>;

constexpr double solver_tolerance = 1e-4;  // residual, relative: errors of u far below the limits
constexpr int most_iterations = 2000;      // an organ of 3500 nodes takes 250
constexpr double limit_of_node = 0.1, limit_of_all = 0.01;
constexpr double accuracies = 3;        // that a compressed compliance may be off by besides
constexpr double limit_of_work = 0.02;  // where only the work is compared

struct Answer {
    std::vector<Vector3d> displacements;  // of contact nodes, mm
    bool converged;
};

// In float32, so that both sides see the same forces.
std::vector<NodeForce> random_load(std::size_t nodes) {
    std::mt19937_64 random(std::random_device{}());
    std::normal_distribution<float> normal;
    std::vector<NodeForce> load;
    for (std::size_t node = 0; node < nodes; ++node)
        load.push_back({static_cast<std::int32_t>(node), {normal(random), normal(random), normal(random)}});
    return load;
}

Answer answer_of_mesh(const DeformableBody& body, const std::vector<NodeForce>& load) {
    const Discretisation discretisation = discretise(body);
    const auto positions = number_free_nodes(discretisation.node_count, discretisation.fixed_nodes);
    const Stiffness stiffness = assemble_stiffness(body.mesh, body.materials, discretisation, positions);
    Gradients gradients;
    gradients.setTolerance(solver_tolerance);
    gradients.setMaxIterations(most_iterations);
    gradients.compute(stiffness);

    const auto row_of = [&](std::size_t c) { return 3 * Index{positions[body.contact_nodes[c]]}; };
    Eigen::VectorXd forces = Eigen::VectorXd::Zero(stiffness.rows());
    for (std::size_t c = 0; c < load.size(); ++c) forces.segment<3>(row_of(c)) = load[c].force.cast<double>();
    const Eigen::VectorXd u = gradients.solve(forces);
    Answer answer{{}, gradients.info() == Eigen::Success};
    for (std::size_t c = 0; c < load.size(); ++c) answer.displacements.emplace_back(u.segment<3>(row_of(c)));
    return answer;
}

std::vector<Eigen::Vector3f> answer_of(const SurfaceCompliance& compliance,
                                       const std::vector<NodeForce>& load) {
    std::vector<Eigen::Vector3f> displacements(load.size(), Eigen::Vector3f::Zero());
    add_displacements(compliance, load, displacements);
    return displacements;
}

template <typename Displacements>
double work(const std::vector<NodeForce>& load, const Displacements& displacements) {
    double sum = 0;
    for (std::size_t c = 0; c < load.size(); ++c)
        sum += load[c].force.template cast<double>().dot(displacements[c].template cast<double>());
    return sum;
}

[[noreturn]] void refuse(const std::string& where, const std::string& found, const std::string& expected) {
    throw InvalidInput({where, found, expected, "its forces would be wrong; build the case again"});
}

}  // namespace

void require_answers_of_mesh(const DeformableBody& body, const std::string& where) {
    const std::vector<NodeForce> load = random_load(body.contact_nodes.size());
    const Answer expected = answer_of_mesh(body, load);
    const std::vector<Eigen::Vector3f> found = answer_of(body.compliance, load);
    if (!expected.converged) {
        if (!(work(load, found) >= (1 - limit_of_work) * work(load, expected.displacements)))
            refuse(where, "is stiffer than mesh and materials", "what they answer to a random load");
        return;
    }
    double squares = 0;
    for (const Vector3d& u : expected.displacements) squares += u.squaredNorm();
    const double compression = accuracies * allowed_error(body.compliance);
    const double all = (limit_of_all + compression) * std::sqrt(squares / static_cast<double>(load.size()));
    for (std::size_t c = 0; c < load.size(); ++c) {
        const Vector3d &there = expected.displacements[c], here = found[c].cast<double>();
        if (!((here - there).norm() <= (limit_of_node + compression) * there.norm() + all))
            refuse(where,
                   "moves contact node " + std::to_string(c) + " by " + std::to_string(here.norm()) +
                       " mm under a random load",
                   std::to_string(there.norm()) + " mm, as mesh and materials do");
    }
}

}  // namespace palpate::elasticity
