// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/solid/least_distance.hpp"

#include <algorithm>
#include <array>
#include <cmath>
#include <optional>

namespace palpate::haptics {
namespace {

using ScaledTouch = Eigen::Matrix<double, 7, 1>;

constexpr std::size_t most_active = 7;
constexpr int most_entering = 100;
constexpr double most_missed = 1e-9;        // mm, by which a touch may be missed
constexpr double left_if_dependent = 1e-9;  // of a column: what is left of it without the others
constexpr double impossible = 1e-12;        // of the residual's square: touches contradict each other

// The touches as the columns (a_i, h_i) of least squares whose residual r tells the solution: with y =
// sqrt(W) (x - x_wanted), the least |y| subject to a_i . y >= h_i is -r_1..6 / r_7 for the u >= 0 of least
// |E u - e_7|.
class LeastDistance {
  public:
    LeastDistance(const Twist& root_spring, const Twist& wanted, std::span<ToolTouch> touches,
                  bool contradict) noexcept
        : root_spring_(root_spring), wanted_(wanted), touches_(touches), contradict_(contradict) {}

    // The scaled motion y, and the presses; nothing if no motion keeps all touches.
    std::optional<Twist> solve() noexcept {
        for (int turn = 0; turn < most_entering; ++turn) {
            update_residual();
            if (residual_.squaredNorm() < impossible) return std::nullopt;
            const std::size_t entering = most_violated();
            if (entering == touches_.size()) break;
            let_in(entering);
        }
        for (std::size_t k = 0; k < count_; ++k) touches_[active_[k]].press = u_[k] / -residual_[6];
        return Twist(-residual_.head<6>() / residual_[6]);
    }

  private:
    ScaledTouch column(std::size_t touch) const noexcept {
        const ToolTouch& it = touches_[touch];
        const double distance = contradict_ ? std::max(it.distance, 0.0) : it.distance;
        ScaledTouch column;
        column.head<6>() = it.slope.cwiseQuotient(root_spring_);
        column[6] = -(distance + it.slope.dot(wanted_));
        return column;
    }

    void update_residual() noexcept {
        residual_ = -ScaledTouch::Unit(6);
        for (std::size_t k = 0; k < count_; ++k) residual_ += u_[k] * columns_[k];
    }

    std::size_t most_violated() const noexcept {
        double most = most_missed * -residual_[6];
        std::size_t worst = touches_.size();
        for (std::size_t i = 0; i < touches_.size(); ++i) {
            const double violated = -column(i).dot(residual_);
            if (!(violated > most) || i == refused_ || is_active(i)) continue;
            most = violated;
            worst = i;
        }
        return worst;
    }
    bool is_active(std::size_t touch) const noexcept {
        return std::find(active_.begin(), active_.begin() + static_cast<std::ptrdiff_t>(count_), touch) !=
               active_.begin() + static_cast<std::ptrdiff_t>(count_);
    }

    // Least squares of the active touches and one more, of which those leave that would pull.
    void let_in(std::size_t touch) noexcept {
        refused_ = touches_.size();
        if (count_ == most_active) leave(0);
        active_[count_] = touch;
        columns_[count_] = column(touch);
        u_[count_++] = 0;
        while (count_ > 0) {
            std::array<double, most_active> wanted{};
            if (!least_squares(wanted)) {
                if (active_[count_ - 1] == touch) refused_ = touch;
                leave(count_ - 1);
                continue;
            }
            double part = 1;
            std::size_t leaving = count_;
            for (std::size_t k = 0; k < count_; ++k) {
                if (wanted[k] > 0) continue;
                const double reach = u_[k] > 0 ? u_[k] / (u_[k] - wanted[k]) : 0;
                if (leaving < count_ && reach >= part) continue;
                part = reach;
                leaving = k;
            }
            for (std::size_t k = 0; k < count_; ++k) u_[k] += part * (wanted[k] - u_[k]);
            if (leaving == count_) return;
            if (active_[leaving] == touch) refused_ = touch;
            leave(leaving);
        }
    }

    void leave(std::size_t k) noexcept {
        for (; k + 1 < count_; ++k) {
            active_[k] = active_[k + 1];
            columns_[k] = columns_[k + 1];
            u_[k] = u_[k + 1];
        }
        --count_;
    }

    // By orthogonal columns (Gram, Schmidt, twice); false if the active ones depend on each other.
    bool least_squares(std::array<double, most_active>& u) const noexcept {
        std::array<ScaledTouch, most_active> Q;
        std::array<std::array<double, most_active>, most_active> R{};
        for (std::size_t k = 0; k < count_; ++k) {
            Q[k] = columns_[k];
            for (int pass = 0; pass < 2; ++pass)
                for (std::size_t j = 0; j < k; ++j) {
                    const double part = Q[j].dot(Q[k]);
                    R[j][k] += part;
                    Q[k] -= part * Q[j];
                }
            R[k][k] = Q[k].norm();
            if (!(R[k][k] > left_if_dependent * columns_[k].norm())) return false;
            Q[k] /= R[k][k];
        }
        for (std::size_t k = count_; k-- > 0;) {
            u[k] = Q[k][6];
            for (std::size_t j = k + 1; j < count_; ++j) u[k] -= R[k][j] * u[j];
            u[k] /= R[k][k];
        }
        return true;
    }

    const Twist root_spring_, wanted_;
    std::span<ToolTouch> touches_;
    const bool contradict_;
    std::array<std::size_t, most_active> active_{};
    std::array<ScaledTouch, most_active> columns_;
    std::array<double, most_active> u_{};
    std::size_t count_ = 0, refused_ = static_cast<std::size_t>(-1);
    ScaledTouch residual_;
};

}  // namespace

NearestMotion nearest_motion(const TurningCoupling& coupling, const ToolPose& pose,
                             std::span<ToolTouch> touches) noexcept {
    Twist root_spring, wanted;
    root_spring.head<3>().setConstant(std::sqrt(coupling.stiffness));
    root_spring.tail<3>().setConstant(std::sqrt(coupling.torsional_stiffness));
    wanted.head<3>() = coupling.device.position - pose.position;
    wanted.tail<3>() = rotation_between(pose.orientation, coupling.device.orientation);
    for (ToolTouch& touch : touches) touch.press = 0;
    const auto moved_by = [&](const Twist& scaled) -> Twist {
        return wanted + scaled.cwiseQuotient(root_spring);
    };
    if (const auto scaled = LeastDistance(root_spring, wanted, touches, false).solve())
        return {moved_by(*scaled), true};
    // No motion always keeps them as they are.
    const auto scaled = LeastDistance(root_spring, wanted, touches, true).solve();
    return {scaled ? moved_by(*scaled) : Twist(Twist::Zero()), false};
}

}  // namespace palpate::haptics
