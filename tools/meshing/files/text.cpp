// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/text.hpp"

#include <algorithm>
#include <fmt/format.h>

namespace palpate::meshing {

std::string lower_case(std::string_view text) {
    std::string lower(text);
    std::ranges::transform(lower, lower.begin(),
                           [](char c) { return c >= 'A' && c <= 'Z' ? static_cast<char>(c + 32) : c; });
    return lower;
}

std::string place_text(const Eigen::Vector3d& p_P) {
    return fmt::format("({:.1f}, {:.1f}, {:.1f})", p_P.x(), p_P.y(), p_P.z());
}

}  // namespace palpate::meshing
