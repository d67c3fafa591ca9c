// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

namespace palpate::cli {

/// Where an output goes.
struct OutputTarget {
    std::filesystem::path path;  ///< links followed, also to what is not there yet; a pipe as it was named
    bool is_pipe = false;        ///< a FIFO, or /dev/stdout before another command
};

/// Throws InvalidInput, naming its kind, for a folder, a device, a socket, "-" and a link that leads to
/// itself.
OutputTarget output_target(const std::filesystem::path& named);

/// Where a file goes that is sought in while it is written, or read again after that, links followed. Throws as
/// output_target(), and for a pipe, which has only an end.
std::filesystem::path seekable_target(const std::filesystem::path& named);

/// The folder that a file is in, "." where its path has none.
std::filesystem::path folder_of(const std::filesystem::path& file);

/// Throws SystemFailure: the target could not be written, for the reason that `error` (errno) tells.
[[noreturn]] void fail_to_write(const std::filesystem::path& target, int error);

}  // namespace palpate::cli
