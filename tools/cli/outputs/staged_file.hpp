// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <sys/types.h>

#include "tools/cli/outputs/output_target.hpp"
#include "tools/cli/outputs/staging.hpp"

namespace palpate::cli {

/// An output that appears whole or not at all: written into a file without a name on the target's disk,
/// flushed and put in its place by commit(), and gone otherwise, however the process ends. Where the system
/// has no such files it has a hidden name, is removed on SIGINT and SIGTERM, and what a killed process left
/// is removed by the next one that writes into the folder. A link is followed: what it leads to is replaced.
/// A pipe, such as a FIFO or /dev/stdout before another command, gets the finished file's bytes.
class StagedFile {
  public:
    /// Throws InvalidInput if `target` exists and `replace` is false, if its folder is missing, or if it is a
    /// folder, a device or a socket; UsageError if it is stdout and another output has that; SystemFailure if
    /// nothing can be written there.
    StagedFile(const std::filesystem::path& target, bool replace);
    StagedFile(const StagedFile&) = delete;
    StagedFile& operator=(const StagedFile&) = delete;
    ~StagedFile();

    /// Where to write, by any writer that does not look at the name and writes into what is there.
    const std::filesystem::path& path() const { return staged_.path; }

    /// Writes the whole content; throws SystemFailure if it does not fit.
    void write_text(const std::string& text) const;

    /// Flushes it and puts it in its place. Throws InvalidInput if it must not replace a file that came there
    /// meanwhile, SystemFailure if it cannot.
    void commit();

  private:
    void take_hidden_name(const std::filesystem::path& folder);

    OutputTarget target_;
    bool replace_;
    Staged staged_;  ///< locked while this lives
    int slot_ = -1;
};

/// Makes SIGINT, SIGTERM and SIGHUP remove all staged files and exit with 130. Called once by Command::run().
void remove_staged_files_on_interrupt();

/// From now on the first of these signals only makes interrupt_asked() true, for a command that has a device
/// to release; its job ends by throwing Interrupted. A second one does as before.
void end_softly_on_interrupt();
bool interrupt_asked();
/// Ends the process with exit code 1 after so many seconds, unless it has ended by then, without what is
/// staged: for what a driver that hangs must not hold up.
void end_within(int seconds);

/// From now on an interrupt is passed on to this child, which is waited for before this process ends; 0 for
/// none.
void pass_interrupts_to(pid_t child);

/// Writes `text` to `target` through a StagedFile.
void write_text_file(const std::filesystem::path& target, const std::string& text, bool replace);

}  // namespace palpate::cli
