// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <memory>
#include <optional>
#include <vector>

#include "runtime/visual/playback/film.hpp"
#include "runtime/visual/train_window.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/outputs/staged_folder.hpp"

namespace palpate::apps {

/// The films that a command was asked for, each there as a whole after commit() or not at all.
class FilmOutput {
  public:
    /// Empty paths are not asked for. `video`: a file. `pictures`: a folder of PNG files, which is made.
    /// `rate`: pictures a second. Throws InvalidInput if the file exists without --force, or if there is
    /// something where the folder is to be: --force empties no folder.
    FilmOutput(const std::filesystem::path& video, const std::filesystem::path& pictures, int rate,
               const cli::Session& session);

    bool asked() const { return !films_.empty(); }
    /// Adds what the window shows.
    void take(visual::TrainWindow& window);
    void commit();

  private:
    std::optional<cli::StagedFile> video_;
    std::optional<cli::StagedFolder> pictures_;
    std::vector<std::unique_ptr<visual::Film>> films_;
};

}  // namespace palpate::apps
