// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/contact/contact_scheme.hpp"

#include <algorithm>
#include <string>

#include "formats/model/errors.hpp"

namespace palpate {

ContactScheme find_contact_scheme(std::string_view name) {
    const auto found = std::ranges::find(contact_scheme_names, name);
    if (found == contact_scheme_names.end())
        throw UsageError({"--scheme", std::string(name), "single, twice or continuous", ""});
    return static_cast<ContactScheme>(found - contact_scheme_names.begin());
}

}  // namespace palpate
