// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/software.hpp"

#include <nlohmann/json.hpp>
#include <sstream>
#include <string>

#include "tools/cli/command.hpp"

namespace palpate::cli {

nlohmann::ordered_json software_versions() {
    nlohmann::ordered_json libraries = nlohmann::ordered_json::object();
    std::istringstream pairs(PALPATE_LIBRARIES);  // "CGAL 5.5.1 Eigen 3.4.0 ..."
    for (std::string name, number; pairs >> name >> number;) libraries[name] = number;
    return {{"palpate", version()}, {"libraries", libraries}};
}

std::filesystem::path programs_folder() {
    return std::filesystem::read_symlink("/proc/self/exe").parent_path();
}

}  // namespace palpate::cli
