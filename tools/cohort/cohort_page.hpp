// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>

#include "tools/cohort/results.hpp"

namespace palpate::cohort {

/// Makes one HTML page on a cohort: patients by status with a picture, their figures, those that stand apart
/// marked, and links to each one's report or to what there was when he failed; distributions of the figures;
/// what the stages took. `name` is its title. Pictures are within, links relative to the cohort's folder.
std::string cohort_page(const std::string& name, std::span<const PatientResult> results);

}  // namespace palpate::cohort
