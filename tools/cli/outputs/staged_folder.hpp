// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

namespace palpate::cli {

/// A folder of outputs that appears whole or not at all: filled under a hidden name beside the target, with
/// which commit() exchanges it, removed otherwise. What a killed process left there, the next one for the
/// same target removes. A job that uses one asks end_softly_on_interrupt() and looks at interrupt_asked().
class StagedFolder {
  public:
    /// Throws InvalidInput if `target` is there, but for an empty folder, and `replace` is false, if the
    /// folder that it goes into is missing, or if another process fills the same one; SystemFailure if
    /// nothing can be written there.
    StagedFolder(const std::filesystem::path& target, bool replace);
    StagedFolder(const StagedFolder&) = delete;
    StagedFolder& operator=(const StagedFolder&) = delete;
    ~StagedFolder();

    /// Where to put the files, each flushed to disk, as StagedFile does.
    const std::filesystem::path& path() const { return staged_; }

    /// Puts the folder in the target's place; what was there goes with this object. Throws SystemFailure if
    /// it cannot, InvalidInput if another process writes there or if the file system cannot exchange two
    /// folders at once, and leaves the target.
    void commit();

  private:
    void discard();

    std::filesystem::path target_, staged_;
    int lock_ = -1, replaced_ = -1;  // descriptors that hold locks
};

}  // namespace palpate::cli
