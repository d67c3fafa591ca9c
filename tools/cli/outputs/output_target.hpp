// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

namespace palpate::cli {

/// Where an output goes.
struct OutputTarget {
    std::filesystem::path path;  ///< links followed, also to what is not there yet; a pipe as it was named
    bool is_pipe = false;        ///< a FIFO, or /dev/stdout before another command
};

/// Throws InvalidInput, naming its kind, for a folder, a device, a socket, "-" and a link that leads to
/// itself.
OutputTarget output_target(const std::filesystem::path& named);

/// Where a file goes that is sought in while it is written, or read again after that, links followed. Throws
/// as output_target(), and for a pipe, which has only an end.
std::filesystem::path seekable_target(const std::filesystem::path& named);

/// Throws InvalidInput, naming its kind, for what is no folder and stands where a folder for outputs, or one
/// above it, is to be, and for "-".
void require_folder_target(const std::filesystem::path& named);

/// Gives stdout to an output if that goes there, as /dev/stdout or under the name of the pipe or file behind
/// it. Throws UsageError if another output has it.
void take_stdout_for(const std::filesystem::path& output);

/// Gives it to what is written there under no path, such as the JSON of "--json -".
void take_stdout_as(const std::string& name);

/// Whether an output has stdout, so that what is told besides goes to stderr.
bool stdout_is_taken();

/// Writes what std::cout holds. Throws SystemFailure if that, or anything before, did not get out.
void flush_stdout();

/// The folder that a file is in, "." where its path has none.
std::filesystem::path folder_of(const std::filesystem::path& file);

/// Throws SystemFailure: the target could not be written, for the reason that `error` (errno) tells.
[[noreturn]] void fail_to_write(const std::filesystem::path& target, int error);

}  // namespace palpate::cli
