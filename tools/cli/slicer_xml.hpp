// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

namespace palpate::cli {

class Command;

/// Describes a command in 3D Slicer's Execution Model XML, from the same definitions as its help.
std::string slicer_xml(const Command& command);

}  // namespace palpate::cli
