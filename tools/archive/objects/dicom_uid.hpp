// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <string_view>

namespace palpate::archive {

/// Makes the UID of a part from what it holds: "2.25." and, in decimal, the UUID of version 8 (RFC 9562 5.8)
/// whose bits are the first of SHA-256(digest, role). The same content has the same UIDs, and nothing else
/// has. Source: PS3.5 B.2.
std::string uid_of(const std::string& digest, std::string_view role);

}  // namespace palpate::archive
