// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>

namespace palpate {

/// Throws InvalidInput if `path` is there and no file, as a pipe or a device without end, or one of more than
/// `most` bytes: for readers of what people write, which take a file into memory whole.
void require_small_file(const std::filesystem::path& path, std::uintmax_t most);

}  // namespace palpate
