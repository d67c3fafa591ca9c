// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace palpate::devices {

/// The hand that holds a simulated device: a spring and a damper towards where it wants to be, and towards
/// how it wants its tool turned. All zero: no hand.
struct HandImpedance {
    double stiffness = 0.3;  ///< N/mm
    double damping = 2e-3;   ///< N s/mm
    // A choice: those above, 30 mm from the tip.
    double torsional_stiffness = 270;  ///< N mm/rad
    double torsional_damping = 1.8;    ///< N mm s/rad
};

}  // namespace palpate::devices
