// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/doctor/finding.hpp"
#include "runtime/doctor/machine.hpp"

namespace palpate::doctor {

/// Looks for OpenHaptics' device library, by PALPATE_HD_LIBRARY or by its known names, and for the libraries
/// it needs and those that these need, without loading any: a driver may start when it is loaded. Facts about
/// the names and who brings them: the libraries' own dynamic sections, and the READMEs of
/// jhu-saw/sawSensablePhantom and jstmn/touch3d-drone-control.
Findings library_findings(const Machine& machine);

}  // namespace palpate::doctor
