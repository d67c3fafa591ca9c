// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <nlohmann/json_fwd.hpp>
#include <string>

#include "runtime/doctor/finding.hpp"
#include "runtime/doctor/machine.hpp"

namespace palpate::doctor {

/// The findings for a person: a heading for each group, a line for each finding, its fix below.
std::string report_text(const Findings& findings);

/// The findings for support, as an array of objects; nothing in it names the user, see anonymous().
nlohmann::ordered_json report_json(const Findings& findings, const Machine& machine);

/// Puts ~ for the user's home (and any other's), $USER for the user and $HOSTNAME for the machine, where they
/// stand as words of their own.
std::string anonymous(std::string text, const Machine& machine);

}  // namespace palpate::doctor
