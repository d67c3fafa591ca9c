// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/experiments/stability/wall_stability.hpp"

#include <Eigen/Eigenvalues>
#include <algorithm>
#include <cmath>
#include <limits>
#include <unsupported/Eigen/MatrixFunctions>

namespace palpate::experiments {
namespace {

constexpr double wall_tick_s = 1e-3;

// The least stiffness that is not stable.
double limit_of(double start, const std::function<bool(double stiffness)>& stable) {
    double above = start;
    while (stable(above)) above *= 1.2;
    double below = above / 1.2;
    while (above / below > 1.0005) {
        const double middle = std::sqrt(above * below);
        (stable(middle) ? below : above) = middle;
    }
    return std::sqrt(above * below);
}

double first_guess(const WallLoop& loop) {
    return 0.02 * passivity_limit(loop);
}

// (position, velocity) after `time` from (position, velocity, force).
Eigen::Matrix<double, 2, 3> transition_of(const WallLoop& loop, double time) {
    const double mass = 1e-3 * loop.model.mass_kg;  // N s²/mm
    Eigen::Matrix3d rates = Eigen::Matrix3d::Zero();
    rates(0, 1) = 1;
    rates.row(1) << -loop.hand.stiffness / mass, -(loop.model.damping + loop.hand.damping) / mass, 1 / mass;
    const Eigen::Matrix3d exact = (time * rates).exp();
    return exact.topRows<2>();
}

}  // namespace

Wall spring_wall(double stiffness) {
    return [stiffness](double depth) { return stiffness * std::max(0.0, depth); };
}

StabilityTrial try_wall(const WallLoop& loop, double stiffness, const Wall& wall, int refreshes) {
    constexpr double rest = StabilityTrial::rest_depth, start = rest + StabilityTrial::start_deviation;
    // The hand's spring rests at the start, so its force at the rest depth is part of the load's task.
    const double load = stiffness * rest + loop.hand.stiffness * (rest - start);
    devices::DynamicDevice device(loop.model, loop.hand, devices::HandPath({{0, {0, 0, -start}}}));
    const int ticks = refreshes * loop.refresh_ticks;
    constexpr double never = std::numeric_limits<double>::infinity();
    double force = 0, shallowest = never, deepest = -never;
    for (int tick = 0; tick < ticks; ++tick) {
        const realtime::DeviceState state = device.read(wall_tick_s * tick);
        if (tick % loop.refresh_ticks == 0) {
            force = wall(-state.position[2]) - load;
            const double depth = -device.position().z();
            if (!(std::abs(depth) < 1000)) return {false, std::abs(depth)};
            if (tick >= ticks - ticks / 4) {
                shallowest = std::min(shallowest, depth);
                deepest = std::max(deepest, depth);
            }
        }
        device.write({{0, 0, force}});
    }
    const double largest = std::max(deepest - rest, rest - shallowest);
    return {largest <= StabilityTrial::start_deviation, (deepest - shallowest) / 2};
}

double measured_limit(const WallLoop& loop, const WallMaker& wall) {
    return limit_of(first_guess(loop),
                    [&](double stiffness) { return try_wall(loop, stiffness, wall(stiffness)).stable; });
}

double eigenvalue_limit(const WallLoop& loop) {
    const double late = wall_tick_s * loop.model.delay_ticks,
                 prompt = wall_tick_s * loop.refresh_ticks - late;
    const auto before = transition_of(loop, late), after = transition_of(loop, prompt);
    const Eigen::Vector2d last_force = after.leftCols<2>() * before.col(2), force = after.col(2);
    Eigen::Matrix3d open = Eigen::Matrix3d::Zero();
    open.topLeftCorner<2, 2>() = after.leftCols<2>() * before.leftCols<2>();
    open.topRightCorner<2, 1>() = last_force;
    const Eigen::Vector3d input(force[0], force[1], 1);
    return limit_of(first_guess(loop), [&](double stiffness) {
        Eigen::Matrix3d closed = open;
        closed.col(0) -= stiffness * input;
        return closed.eigenvalues().cwiseAbs().maxCoeff() <= 1;
    });
}

double passivity_limit(const WallLoop& loop) {
    return 2 * loop.model.damping / (wall_tick_s * loop.refresh_ticks);
}

}  // namespace palpate::experiments
