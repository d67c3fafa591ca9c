// SPDX-License-Identifier: GPL-3.0-or-later
#include <Eigen/Geometry>
#include <Eigen/LU>
#include <algorithm>
#include <gtest/gtest.h>
#include <limits>
#include <random>
#include <vector>

#include "formats/hyperelasticity/neo_hookean.hpp"

namespace palpate {
namespace {

using hyperelasticity::moduli_of;
using hyperelasticity::neo_hookean;
using hyperelasticity::Stressed;

// All of the largest modulus: a dozen products of numbers of order one keep 14 digits; a central difference
// by steps of 1e-5 is off by their square times the third derivative, some tens, and by round-off over them.
constexpr double products_rounding = 1e-14;
constexpr double difference_step = 1e-5, difference_error = 1e-8;
constexpr int random_states = 50;

// Liver, a stiff sponge, one that widens when pulled, and one that hardly changes its volume.
const std::vector<Material> laws{{6.3e-3, 0.45}, {1, 0}, {0.02, -0.4}, {6.3e-3, 0.4999}};

double largest_of(const Material& law) {
    const auto moduli = moduli_of(law);
    return std::max(moduli.shear, moduli.bulk);
}

class States {
  public:
    explicit States(unsigned seed) : random_(seed) {}
    Eigen::Matrix3d any() {
        return Eigen::Matrix3d::NullaryExpr([&] { return uniform_(random_); });
    }
    // Large, and the right side out.
    Eigen::Matrix3d deformation() {
        for (;;) {
            const Eigen::Matrix3d F = Eigen::Matrix3d::Identity() + 0.5 * any();
            if (F.determinant() > 0.3) return F;
        }
    }
    Eigen::Matrix3d rotation() {
        return Eigen::Quaterniond(uniform_(random_), uniform_(random_), uniform_(random_), uniform_(random_))
            .normalized()
            .toRotationMatrix();
    }

  private:
    std::mt19937 random_;
    std::uniform_real_distribution<double> uniform_{-1, 1};
};

TEST(NeoHookean, moduli_give_back_youngs_modulus_and_poissons_ratio) {
    for (const Material& law : laws) {
        const auto [mu, kappa] = moduli_of(law);
        EXPECT_NEAR(9 * kappa * mu / (3 * kappa + mu), law.youngs_modulus, 1e-14 * law.youngs_modulus);
        // 3 kappa - 2 mu loses, where the material has hardly any volume to give, what 1 - 2 nu has lost.
        EXPECT_NEAR((3 * kappa - 2 * mu) / (2 * (3 * kappa + mu)), law.poissons_ratio, 1e-14);
    }
}

TEST(NeoHookean, stress_is_the_gradient_of_its_energy) {
    States states(1);
    for (const Material& law : laws)
        for (int k = 0; k < random_states; ++k) {
            const Eigen::Matrix3d F = states.deformation();
            const auto stressed = neo_hookean(F, moduli_of(law));
            for (Eigen::Index i = 0; i < 9; ++i) {
                Eigen::Matrix3d ahead = F, behind = F;
                ahead.reshaped()[i] += difference_step;
                behind.reshaped()[i] -= difference_step;
                const double slope =
                    (neo_hookean(ahead, moduli_of(law)).energy - neo_hookean(behind, moduli_of(law)).energy) /
                    (2 * difference_step);
                EXPECT_NEAR(stressed.stress.reshaped()[i], slope, difference_error * largest_of(law));
            }
        }
}

TEST(NeoHookean, turned_tissue_has_neither_energy_nor_stress) {
    States states(2);
    for (const Material& law : laws)
        for (int k = 0; k < random_states; ++k) {
            const auto stressed = neo_hookean(states.rotation(), moduli_of(law));
            EXPECT_NEAR(stressed.energy, 0, products_rounding * largest_of(law));
            EXPECT_LT(stressed.stress.cwiseAbs().maxCoeff(), products_rounding * largest_of(law));
        }
}

TEST(NeoHookean, energy_is_positive_but_for_rotations) {
    States states(3);
    for (const Material& law : laws)
        for (int k = 0; k < random_states; ++k)
            EXPECT_GT(neo_hookean(states.deformation(), moduli_of(law)).energy, 0);
}

// `other` is as far deformed as before, and `expected` its stress.
void expect_as_deformed(const Stressed& other, const Stressed& before, const Eigen::Matrix3d& expected,
                        const Material& law) {
    const double rounding = 10 * products_rounding * largest_of(law);
    EXPECT_NEAR(other.energy, before.energy, rounding);
    EXPECT_LT((other.stress - expected).cwiseAbs().maxCoeff(), rounding);
}

TEST(NeoHookean, has_no_grain_and_turning_what_is_deformed_turns_its_stress_and_costs_nothing) {
    States states(4);
    for (const Material& law : laws)
        for (int k = 0; k < random_states; ++k) {
            const Eigen::Matrix3d F = states.deformation(), R = states.rotation();
            const Stressed before = neo_hookean(F, moduli_of(law));
            expect_as_deformed(neo_hookean(R * F, moduli_of(law)), before, R * before.stress, law);
            expect_as_deformed(neo_hookean(F * R, moduli_of(law)), before, before.stress * R, law);
        }
}

// Moments balance: sigma = P Fᵀ / J is symmetric.
TEST(NeoHookean, cauchy_stress_is_symmetric) {
    States states(6);
    for (const Material& law : laws)
        for (int k = 0; k < random_states; ++k) {
            const Eigen::Matrix3d F = states.deformation();
            const Eigen::Matrix3d sigma =
                neo_hookean(F, moduli_of(law)).stress * F.transpose() / F.determinant();
            EXPECT_LT((sigma - sigma.transpose()).cwiseAbs().maxCoeff(),
                      10 * products_rounding * largest_of(law));
        }
}

TEST(NeoHookean, tangent_at_rest_is_hookes_law) {
    for (const Material& law : laws) {
        const double e = law.youngs_modulus, nu = law.poissons_ratio;
        const double lambda = e * nu / ((1 + nu) * (1 - 2 * nu)), mu = e / (2 * (1 + nu));
        for (Eigen::Index i = 0; i < 9; ++i) {
            Eigen::Matrix3d H = Eigen::Matrix3d::Zero();
            H.reshaped()[i] = 1;
            const Eigen::Matrix3d I = Eigen::Matrix3d::Identity(), strain = (H + H.transpose()) / 2,
                                  hooke = lambda * strain.trace() * I + 2 * mu * strain;
            const Eigen::Matrix3d slope = (neo_hookean(I + difference_step * H, moduli_of(law)).stress -
                                           neo_hookean(I - difference_step * H, moduli_of(law)).stress) /
                                          (2 * difference_step);
            EXPECT_LT((slope - hooke).cwiseAbs().maxCoeff(), difference_error * largest_of(law));
        }
    }
}

TEST(NeoHookean, energy_is_infinite_where_nothing_or_less_is_left_of_a_volume) {
    const auto energy = [](const Eigen::Matrix3d& F) { return neo_hookean(F, moduli_of(laws[0])).energy; };
    constexpr double infinity = std::numeric_limits<double>::infinity();
    EXPECT_EQ(energy(Eigen::Matrix3d::Zero()), infinity);
    EXPECT_EQ(energy(-Eigen::Matrix3d::Identity()), infinity);
    EXPECT_EQ(energy(Eigen::Vector3d(1, 1, 0).asDiagonal()), infinity);
    EXPECT_EQ(energy(Eigen::Vector3d(1, -1e-9, 1).asDiagonal()), infinity);
    EXPECT_EQ(energy(Eigen::Matrix3d::Constant(std::numeric_limits<double>::quiet_NaN())), infinity);
}

// J^(-2/3) has no bound.
TEST(NeoHookean, flattening_costs_without_bound) {
    double before = 0;
    for (const double thickness : {1e-2, 1e-5, 1e-8, 1e-11}) {
        const double energy =
            neo_hookean(Eigen::Vector3d(1, 1, thickness).asDiagonal(), moduli_of(laws[0])).energy;
        EXPECT_GT(energy, 5 * before);
        before = energy;
    }
}

// F = c I: W = kappa/2 (c³ - 1)², P = kappa (c³ - 1) c² I.
TEST(NeoHookean, swelling_is_resisted_by_the_bulk_modulus_alone) {
    for (const Material& law : laws)
        for (const double c : {0.5, 0.9, 1.1, 2.0}) {
            const double kappa = moduli_of(law).bulk;
            const auto stressed = neo_hookean(c * Eigen::Matrix3d::Identity(), moduli_of(law));
            const double J = c * c * c, rounding = 100 * products_rounding * largest_of(law);
            EXPECT_NEAR(stressed.energy, kappa / 2 * (J - 1) * (J - 1), rounding);
            EXPECT_LT((stressed.stress - kappa * (J - 1) * c * c * Eigen::Matrix3d::Identity())
                          .cwiseAbs()
                          .maxCoeff(),
                      rounding);
        }
}

// F = I + g e_x e_yᵀ: J = 1 and W = mu/2 g²; sigma = mu (B - tr B/3 I), whose sigma_xx - sigma_yy is
// g sigma_xy (Rivlin) for any isotropic law.
TEST(NeoHookean, simple_shear_is_resisted_by_the_shear_modulus_alone) {
    for (const Material& law : laws)
        for (const double g : {0.01, 0.5, 2.0}) {
            const double mu = moduli_of(law).shear, rounding = 100 * products_rounding * largest_of(law);
            Eigen::Matrix3d F = Eigen::Matrix3d::Identity();
            F(0, 1) = g;
            const auto stressed = neo_hookean(F, moduli_of(law));
            EXPECT_NEAR(stressed.energy, mu / 2 * g * g, rounding);
            const Eigen::Matrix3d sigma = stressed.stress * F.transpose();
            Eigen::Matrix3d expected;
            expected << 2 * g * g / 3, g, 0, g, -g * g / 3, 0, 0, 0, -g * g / 3;
            EXPECT_LT((sigma - mu * expected).cwiseAbs().maxCoeff(), rounding);
        }
}

}  // namespace
}  // namespace palpate
