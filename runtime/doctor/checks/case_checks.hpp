// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/model/body.hpp"
#include "runtime/doctor/finding.hpp"

namespace palpate::doctor {

/// Holds a case against each device model: whether what can be touched fits its workspace, axis by axis in
/// the best order of axes, and whether the device renders the stiffness and the force that the case asks for
/// (coupling_stiffness()). Deformable bodies are what a case is about: only they can be too large.
/// Throws InvalidInput as coupling_stiffness() does.
Findings case_findings(const Case& patient_case);

}  // namespace palpate::doctor
