// SPDX-License-Identifier: Apache-2.0
#include "formats/model/errors.hpp"

#include <utility>

namespace palpate {

std::string to_string(const ErrorDetail& detail) {
    std::string message = detail.culprit;
    if (!detail.culprit.empty() && !detail.found.empty()) message += ": ";
    message += detail.found;
    if (!detail.expected.empty()) message += " (expected " + detail.expected + ")";
    if (!detail.next_step.empty()) message += "; " + detail.next_step;
    return message;
}

Error::Error(ErrorDetail detail) : std::runtime_error(to_string(detail)), detail_(std::move(detail)) {}

}  // namespace palpate
