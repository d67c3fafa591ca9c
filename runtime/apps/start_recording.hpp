// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "formats/recording/recording_writer.hpp"
#include "runtime/session/session.hpp"
#include "tools/cli/command.hpp"

namespace palpate::apps {

/// Makes a command's recording of `run`, of its last `seconds`, and opens it. It has its final name from here
/// on, so that it is kept however the run ends. Throws InvalidInput if there is such a file without --force,
/// or what is no file.
inline void start_recording(session::Session& run, const std::filesystem::path& named, double seconds,
                            const cli::Session& session) {
    const std::int64_t rows = session::recording_rows(seconds, run.model().tool_count());
    const std::filesystem::path path = cli::seekable_target(named);
    cli::StagedFile empty = session.stage(path);
    recording::make_recording(empty.path(), run.recording_head(cli::version()), rows);
    empty.commit();
    run.record_to(path);
}

}  // namespace palpate::apps
