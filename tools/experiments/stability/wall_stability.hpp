// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>

#include "runtime/devices/dynamics/dynamic_device.hpp"

namespace palpate::experiments {

/// A device in front of a virtual wall whose force is computed every `refresh_ticks` ms and held between.
struct WallLoop {
    devices::DeviceModel model;
    devices::HandImpedance hand;
    int refresh_ticks = 1;
};

/// Force of a wall (N, outwards) on a tip at a depth (mm, negative outside).
using Wall = std::function<double(double depth)>;
/// Makes the wall of a stiffness, N/mm.
using WallMaker = std::function<Wall(double stiffness)>;

/// F = K max(0, depth).
Wall spring_wall(double stiffness);

/// A tip pressed `rest_depth` deep by a constant load is let go `start_deviation` deeper. The loop counts as
/// unstable if in the last quarter of the time the tip is ever farther from the rest depth than it started,
/// or at any time 1 m.
struct StabilityTrial {
    static constexpr double rest_depth = 2, start_deviation = 1;  // mm
    static constexpr int refreshes = 2000;
    bool stable = false;
    double residual_swing = 0;  ///< half of the way between the extremes in the last quarter, mm
};
StabilityTrial try_wall(const WallLoop& loop, double stiffness, const Wall& wall,
                        int refreshes = StabilityTrial::refreshes);

/// Finds, to 0.05 %, the stiffness (N/mm) at which the loop goes unstable: the first found by steps of 20 %.
double measured_limit(const WallLoop& loop, const WallMaker& wall);

/// The same from the spectral radius of the closed loop's transition matrix over one refresh, exact for zero-
/// order hold: x_k+1 = Phi x_k + Gamma_1 F_k-1 + Gamma_0 F_k with F = -K x, delay included; no friction, no
/// encoder, wall never left (Astrom, Wittenmark, Computer-Controlled Systems, 1997, section 2.3).
double eigenvalue_limit(const WallLoop& loop);

/// 2 b / T with the device's own damping, N/mm (Colgate, Schenkel 1997, for a wall without damping).
double passivity_limit(const WallLoop& loop);

}  // namespace palpate::experiments
