// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "tools/case_builder/case_file.hpp"

namespace palpate::case_builder {

/// What a person should know of a case beside its certificate, one sentence each: what is made up, where
/// mechanical values come from, values that are implausible. None names a file.
std::vector<std::string> cautions_of(const CaseFile& case_file);

/// The part of them that is probably a mistake: values that no tissue or tool has.
std::vector<std::string> doubts_of(const CaseFile& case_file);

}  // namespace palpate::case_builder
