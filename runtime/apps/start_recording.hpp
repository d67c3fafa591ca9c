// SPDX-License-Identifier: Apache-2.0
#pragma once
#include "runtime/apps/run_recorder.hpp"
#include "tools/cli/command.hpp"

namespace palpate {

/// Makes a command's recording and opens it. It has its final name from here on, so that it is kept however
/// the run ends. Throws InvalidInput if there is such a file without --force.
inline RunRecorder start_recording(const std::filesystem::path& path, const RecordingHead& head,
                                   double seconds, const cli::Session& session) {
    cli::StagedFile empty = session.stage(path);
    make_recording(empty.path(), head, recording_rows(seconds, head.devices.size()));
    empty.commit();
    return RunRecorder(path);
}

}  // namespace palpate
