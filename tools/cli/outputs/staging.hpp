// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

namespace palpate::cli {

/// A file or folder of ours that is not in its place yet, and a descriptor of it that holds its lock.
struct Staged {
    int descriptor = -1;
    std::filesystem::path path;  ///< where to write, also where it has no name
    bool has_name = true;
};

/// Creates a file of its own in `folder`: without a name where the system can, so that nothing is left of it
/// if its process is killed, and under a hidden one that ends in the target's elsewhere, locked, so that
/// others can tell that its process lives. Throws SystemFailure if it cannot be made.
Staged create_staged(const std::filesystem::path& folder, const std::filesystem::path& target);

/// The same of a folder in `folder`, which always has a hidden name.
Staged create_staged_folder(const std::filesystem::path& folder, const std::filesystem::path& target);

/// Gives a file without a name a hidden one in `folder`, from which it can replace the target. Throws
/// SystemFailure.
void give_name(Staged& staged, const std::filesystem::path& folder, const std::filesystem::path& target);

/// Removes what killed processes of this machine left staged in a folder. Where it cannot be locked, as on
/// some network file systems, nobody can tell whether its process lives, and it stays; so does what other
/// machines staged.
void remove_orphans(const std::filesystem::path& folder);

/// Waits until a file's content, or a folder's names, are on the disk. Throws SystemFailure that names
/// `target`.
void flush_to_disk(const std::filesystem::path& path, const std::filesystem::path& target);

/// Puts final names into a message in the place of temporary ones.
std::string with_final_names(std::string message);

}  // namespace palpate::cli
