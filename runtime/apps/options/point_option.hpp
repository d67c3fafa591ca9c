// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <optional>
#include <sstream>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate::apps {

/// Reads "x,y,z", the value of an option; nothing for none. Throws UsageError naming the option.
inline std::optional<Eigen::Vector3d> point_of(const char* option, const std::string& text) {
    if (text.empty()) return std::nullopt;
    std::istringstream stream(text);
    Eigen::Vector3d p;
    char comma = ',', other_comma = ',';
    stream >> p[0] >> comma >> p[1] >> other_comma >> p[2];
    if (!stream || comma != ',' || other_comma != ',' || stream.peek() != EOF)
        throw UsageError({option, text, "x,y,z", ""});
    return p;
}

}  // namespace palpate::apps
