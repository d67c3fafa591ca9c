// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <fstream>
#include <optional>
#include <string>
#include <vector>

#include "runtime/session/run_record.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {

/// The files that a run of touch leaves behind besides its recording: whole ones or none.
class TouchOutputs {
  public:
    /// An empty path is no file. Throws InvalidInput if one exists without --force.
    TouchOutputs(std::filesystem::path log, const std::filesystem::path& curve, const cli::Session& session);

    /// One for each tool, writing to the log if there is one.
    std::vector<session::RunRecord> records_of(const haptics::HapticModel& model);

    /// Writes the curve of the first tool and gives both files their names.
    void commit(const session::RunRecord& first, const std::string& title);

  private:
    std::filesystem::path log_path_;
    std::optional<cli::StagedFile> log_file_, curve_file_;
    std::ofstream log_;
};

}  // namespace palpate::apps
