// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

namespace palpate::cli {

/// A file or folder under a temporary name, and a descriptor of it that holds its lock.
struct StagedName {
    int descriptor = -1;
    std::filesystem::path path;
};

/// Creates a file of its own in `folder`, whose name ends in the target's, and locks it, so that others can
/// tell that its process lives. Throws SystemFailure if it cannot be made.
StagedName create_staged(const std::filesystem::path& folder, const std::filesystem::path& target);

/// The same of a folder in `folder`.
StagedName create_staged_folder(const std::filesystem::path& folder, const std::filesystem::path& target);

/// Removes what killed processes of this machine left staged in a folder. Where it cannot be locked, as on
/// some network file systems, nobody can tell whether its process lives, and it stays; so does what other
/// machines staged.
void remove_orphans(const std::filesystem::path& folder);

/// Waits until a file's content, or a folder's names, are on the disk. Throws SystemFailure that names
/// `target`.
void flush_to_disk(const std::filesystem::path& path, const std::filesystem::path& target);

/// Makes a folder that nobody else looks into. Throws SystemFailure.
std::filesystem::path make_private_folder(const std::filesystem::path& target);

/// Puts final names into a message in the place of temporary ones.
std::string with_final_names(std::string message);

}  // namespace palpate::cli
