// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

namespace palpate::cli {

inline constexpr int most_attempts = 100;  // at a name that no other file has

/// A file or folder of ours that is not in its place yet, and a descriptor of it that holds its lock.
struct Staged {
    int descriptor = -1;
    std::filesystem::path path;  ///< where to write, also where it has no name
    bool has_name = true;
};

/// Creates a file of its own in `folder`: without a name where the system can, so that nothing is left of it
/// if its process is killed, and under a hidden one that ends in the target's elsewhere, locked, so that
/// others can tell that its process lives. `is_private`: nobody else may read it. Throws SystemFailure if it
/// cannot be made.
Staged create_staged(const std::filesystem::path& folder, const std::filesystem::path& target,
                     bool is_private = false);

/// The same of a folder in `folder`, which always has a hidden name.
Staged create_staged_folder(const std::filesystem::path& folder, const std::filesystem::path& target);

/// The hidden name that a file of this process gets in `folder` before it takes its target's.
std::filesystem::path staged_name(const std::filesystem::path& folder, const std::filesystem::path& target,
                                  int attempt);

/// Gives a file without a name this one; false if another has it. Throws SystemFailure that names `target`.
bool give_name(const Staged& staged, const std::filesystem::path& name, const std::filesystem::path& target);

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
