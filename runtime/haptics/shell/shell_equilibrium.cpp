// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/shell/shell_equilibrium.hpp"

#include "runtime/haptics/whole_tool/penalty_equilibrium.hpp"

namespace palpate::haptics {

ToolRest bring_to_rest(ShellWatch& watch, const TurningCoupling& coupling, double contact_stiffness,
                       double longest_step, ToolPose& pose) noexcept {
    return rest_of_penalties(
        watch, coupling, contact_stiffness, [&] { return longest_step; }, PenaltyEffort{}, pose);
}

}  // namespace palpate::haptics
