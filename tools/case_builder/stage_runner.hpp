// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

namespace palpate::case_builder {

/// One step of a build: a palpate command that turns input files into output files.
struct Stage {
    std::string name;                            ///< "mesh wall"; unique in a build
    std::string command;                         ///< "mesh" runs palpate-mesh
    nlohmann::ordered_json request;              ///< what the command is asked for, see cli::Command
    std::vector<std::filesystem::path> inputs;   ///< files (or folders) whose content decides about a rerun
    std::vector<std::filesystem::path> outputs;  ///< files that must be there afterwards
};

/// What a stage took, this time or when it last ran.
struct StageRecord {
    std::string name;
    bool ran = false;  ///< false: up to date, nothing was done
    double seconds = 0;
    std::int64_t peak_memory_bytes = 0;
    nlohmann::ordered_json result;  ///< the command's JSON result
};

/// What stopped a stage when it ran last.
struct StageFailure {
    int exit_code = 0;  ///< of the command; 128 + signal if a signal ended it
    std::string said;   ///< the command's own message, one or more lines
};

/// True for what the same input meets again: bad input, bad usage, a contract that cannot be kept. Anything
/// else may be the machine's.
bool is_lasting(const StageFailure& failure);

/// Throws what a stage's exit code means: InvalidInput, QualityNotMet, cli::Interrupted ...
[[noreturn]] void throw_failure(const std::string& stage_name, int exit_code);

/// SHA-256 of a file's content; of a folder, of its files' relative names and digests. Throws InvalidInput
/// for a pipe, a device or a socket, which may have no end.
std::string content_digest(const std::filesystem::path& path);

/// Runs stages in order, each only if its program, request or the content of an input changed since its
/// record in `folder`, or an output is missing or altered. Each leaves its request as
/// `<stage>.request.json`, the command's result as `<stage>.json` and its record as `<stage>.stage.json`,
/// blanks written as '-'; one that fails `<stage>.failure.json` and, as text, `<stage>.error.txt`. Two
/// processes that run the same stage in the same folder wait for each other.
class StageRunner {
  public:
    /// `programs` holds the palpate-<command> executables; `folder` is made by the first run().
    StageRunner(std::filesystem::path programs, std::filesystem::path folder, int threads, bool quiet);

    /// Throws throw_failure() after the child itself has said why; finished stages stay recorded.
    StageRecord run(Stage stage) const;

    /// The stage's record, whether anything changed since or not; none if it was never done.
    std::optional<StageRecord> recorded(const std::string& stage_name) const;

    /// The stage's record if nothing that decides about it changed since, else none.
    std::optional<StageRecord> finished(Stage stage) const;

    /// How the stage failed if it did with all that decides about it as it is now, else none.
    std::optional<StageFailure> failed(const Stage& stage) const;

    /// Where a stage leaves its command's JSON result; later stages may name it as an input.
    std::filesystem::path result_path(const std::string& stage_name) const;
    /// What the stage said when it failed last; there only if it did.
    std::filesystem::path error_path(const std::string& stage_name) const;

    /// True if this file is the recorded output of a stage in this folder.
    bool made_by_us(const std::string& stage_name, const std::filesystem::path& output) const;

  private:
    std::filesystem::path record_path(const std::string& stage_name) const;
    std::filesystem::path failure_path(const std::string& stage_name) const;
    std::string key_of(const Stage& stage) const;
    nlohmann::ordered_json run_program(const Stage& stage, const std::string& key) const;

    std::filesystem::path programs_, folder_;
    int threads_;
    bool quiet_;
};

}  // namespace palpate::case_builder
