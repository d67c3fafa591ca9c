// SPDX-License-Identifier: Apache-2.0
#include "formats/elasticity/plausible_compliance.hpp"

#include <Eigen/IterativeLinearSolvers>
#include <cmath>
#include <limits>
#include <random>
#include <vector>

#include "formats/elasticity/discretisation.hpp"
#include "formats/elasticity/stiffness.hpp"
#include "formats/elasticity/two_levels.hpp"
#include "formats/model/errors.hpp"

namespace palpate::elasticity {
namespace {

using Eigen::Index;
using Eigen::Vector3d;
using Stiffness = Eigen::SparseMatrix<double>;
using Gradients = Eigen::ConjugateGradient<Stiffness, Eigen::Lower, TwoLevels>;

// How many random loads a compliance is asked, and how far they are solved, as a part of the residual.
struct Question {
    int loads = 0;
    double tolerance = 0;
};
// Solved so far, u is off by 0.03 in one draw of ten on an organ of 1750 contact nodes, and may be by more
// than most_off where a node happens to move little.
constexpr Question glance{2, 1e-3};
// What settles a doubt: no node moves little under all loads.
constexpr Question scrutiny{8, 1e-5};
constexpr int most_iterations = 20000;

using Load = std::vector<NodeForce>;

// In float32, so that both sides see the same forces.
Load random_load(std::size_t nodes, std::mt19937_64& random) {
    std::normal_distribution<float> normal;
    Load load;
    for (std::size_t node = 0; node < nodes; ++node)
        load.push_back({static_cast<std::int32_t>(node), {normal(random), normal(random), normal(random)}});
    return load;
}

[[noreturn]] void refuse(const std::string& where, const std::string& found, const std::string& expected) {
    throw InvalidInput({where, found, expected, "its forces may be wrong; build the case again"});
}

// K of a body's free nodes, and where its contact nodes are in it.
class MeshAnswers {
  public:
    explicit MeshAnswers(const DeformableBody& body) {
        const Discretisation discretisation = discretise(body);
        const auto positions = number_free_nodes(discretisation.node_count, discretisation.fixed_nodes);
        for (const std::int32_t node : body.contact_nodes) rows_.push_back(3 * Index{positions[node]});
        stiffness_ = assemble_stiffness(body.mesh, body.materials, discretisation, positions);
        gradients_.setMaxIterations(most_iterations);
        if (body.element_order == ElementOrder::quadratic)
            gradients_.preconditioner().add_corners(body, discretisation, positions);
        gradients_.compute(stiffness_);
    }

    // Displacements of the contact nodes, mm; none if the gradients do not converge.
    std::vector<Vector3d> displacements(const Load& load, double tolerance) {
        gradients_.setTolerance(tolerance);
        Eigen::VectorXd forces = Eigen::VectorXd::Zero(stiffness_.rows());
        for (std::size_t c = 0; c < load.size(); ++c)
            forces.segment<3>(rows_[c]) = load[c].force.cast<double>();
        const Eigen::VectorXd u = gradients_.solve(forces);
        std::vector<Vector3d> displacements;
        if (gradients_.info() == Eigen::Success)
            for (const Index row : rows_) displacements.emplace_back(u.segment<3>(row));
        return displacements;
    }

  private:
    std::vector<Index> rows_;
    Stiffness stiffness_;
    Gradients gradients_;
};

std::optional<WorstAnswer> ask(const DeformableBody& body, MeshAnswers& mesh, const Question& question,
                               std::mt19937_64& random) {
    const std::size_t nodes = body.contact_nodes.size();
    std::vector<double> squared_differences(nodes), squared_displacements(nodes);
    for (int k = 0; k < question.loads; ++k) {
        const Load load = random_load(nodes, random);
        const std::vector<Vector3d> expected = mesh.displacements(load, question.tolerance);
        if (expected.empty()) return std::nullopt;
        std::vector<Eigen::Vector3f> found(nodes, Eigen::Vector3f::Zero());
        add_displacements(body.compliance, load, found);
        for (std::size_t c = 0; c < nodes; ++c) {
            squared_differences[c] += (found[c].cast<double>() - expected[c]).squaredNorm();
            squared_displacements[c] += expected[c].squaredNorm();
        }
    }
    WorstAnswer worst;
    for (std::size_t c = 0; c < nodes; ++c) {
        const WorstAnswer here{c, std::sqrt(squared_differences[c]), std::sqrt(squared_displacements[c])};
        if (here.part() > worst.part()) worst = here;
    }
    return worst;
}

}  // namespace

double WorstAnswer::part() const {
    if (difference == 0) return 0;
    return std::isfinite(difference) ? difference / displacement : std::numeric_limits<double>::infinity();
}

std::optional<WorstAnswer> worst_answer(const DeformableBody& body, std::uint64_t seed) {
    std::mt19937_64 random(seed);
    MeshAnswers mesh(body);
    const auto worst = ask(body, mesh, glance, random);
    return worst && worst->part() > most_off ? ask(body, mesh, scrutiny, random) : worst;
}

void require_answers_of_mesh(const DeformableBody& body, const std::string& where, std::uint64_t seed) {
    const auto worst = worst_answer(body, seed);
    if (!worst)
        refuse(where, "cannot be judged by its mesh, which is nearly incompressible or nearly torn",
               "Poisson's ratios up to 0.4999, and moduli within some orders of magnitude of each other");
    if (worst->part() > most_off)
        refuse(where,
               "is off by " + std::to_string(worst->difference) + " mm at contact node " +
                   std::to_string(worst->contact_node) + " under random loads",
               "a tenth at most of the " + std::to_string(worst->displacement) +
                   " mm by which mesh and materials move it");
}

}  // namespace palpate::elasticity
