// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "tools/cli/outputs/staging.hpp"

namespace palpate::cli {

/// A folder of outputs that appears whole or not at all: filled under a hidden name beside the target, with
/// which commit() exchanges it, removed otherwise; what a killed process left there is removed by the next
/// one that writes into the target's folder. A job that uses one asks end_softly_on_interrupt() and looks at
/// interrupt_asked().
class StagedFolder {
  public:
    /// Throws InvalidInput if `target` is there, but for an empty folder, and `replace` is false, if it
    /// is no folder, or if the one that it goes into is missing; SystemFailure if nothing can be written
    /// there.
    StagedFolder(const std::filesystem::path& target, bool replace);
    StagedFolder(const StagedFolder&) = delete;
    StagedFolder& operator=(const StagedFolder&) = delete;
    ~StagedFolder();

    /// Where to put the files.
    const std::filesystem::path& path() const { return staged_.path; }

    /// Flushes all of it and puts it in the target's place; what was there goes with this object. Throws
    /// SystemFailure if it cannot, InvalidInput if the file system cannot exchange two folders at once, and
    /// leaves the target.
    void commit();

  private:
    std::filesystem::path target_;
    Staged staged_;  ///< locked while this lives
};

}  // namespace palpate::cli
