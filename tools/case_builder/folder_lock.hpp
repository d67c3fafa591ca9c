// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace palpate::case_builder {

/// Keeps other processes from doing the same work in the same folder: waits until none of them holds `what`,
/// or, to share it, until none holds it alone. The system frees it when the process ends, however it does.
/// The folder gets a file "lock", which stays.
class FolderLock {
  public:
    enum class Hold { alone, shared };

    /// Throws SystemFailure if the file cannot be made, or on a file system without locks.
    FolderLock(const std::filesystem::path& folder, const std::string& what, Hold hold = Hold::alone);
    FolderLock(const FolderLock&) = delete;
    FolderLock& operator=(const FolderLock&) = delete;
    ~FolderLock();

    /// Tells without waiting whether another process holds or shares `what`. Throws as the constructor does.
    static bool held_by_another(const std::filesystem::path& folder, const std::string& what);

  private:
    int file_ = -1;
};

}  // namespace palpate::case_builder
