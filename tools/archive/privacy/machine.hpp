// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

namespace palpate::archive {

/// What tells a machine and who works at it.
struct Machine {
    std::vector<std::string> users;    ///< login names; none that everybody has, such as root
    std::vector<std::string> hosts;    ///< host names; none that everybody has, such as localhost
    std::vector<std::string> folders;  ///< names below '/' that hold people's files, such as "home"
};

/// This machine's, from the system and from USER, LOGNAME and HOSTNAME.
Machine this_machine();

}  // namespace palpate::archive
