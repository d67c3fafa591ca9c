// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <string>

namespace palpate {

/// Of what is at `path`, links followed, and no file: "is a folder", "is a device", "is a socket" or "is a
/// pipe". Empty of a file and where nothing is.
std::string other_kind(const std::filesystem::path& path);

/// Throws InvalidInput if `path` is there and no file, as a pipe or a device without end, naming its kind, or
/// one of more than `most` bytes: for readers of what people write, which take a file into memory whole.
void require_small_file(const std::filesystem::path& path, std::uintmax_t most);

}  // namespace palpate
