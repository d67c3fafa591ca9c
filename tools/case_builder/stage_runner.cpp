// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/stage_runner.hpp"

#include <algorithm>
#include <csignal>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <map>
#include <mutex>
#include <span>
#include <spdlog/spdlog.h>

#include "formats/asset/hdf5/digest.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"
#include "tools/case_builder/child_process.hpp"
#include "tools/case_builder/folder_lock.hpp"
#include "tools/cli/command.hpp"

namespace palpate::case_builder {
namespace {

using namespace asset;

std::string digest_of_text(const std::string& text) {
    return sha256(std::as_bytes(std::span(text)));
}

// Of a program, worked out once for as long as its file is not written anew.
std::string program_digest(const std::filesystem::path& program) {
    static std::mutex mutex;
    static std::map<std::pair<std::filesystem::path, std::filesystem::file_time_type>, std::string> known;
    const std::scoped_lock lock(mutex);
    std::error_code missing;  // is told by who reads it
    const auto written = std::filesystem::last_write_time(program, missing);
    std::string& digest = known[{program, written}];
    if (digest.empty()) digest = sha256_file(program);
    return digest;
}

std::string text_of(const std::filesystem::path& path) {
    std::ifstream stream(path);
    return {std::istreambuf_iterator<char>(stream), {}};
}

nlohmann::ordered_json read_json(const std::filesystem::path& path) {
    std::ifstream stream(path);
    return nlohmann::ordered_json::parse(stream, nullptr, false);
}

// A request with the names of its stage's files instead of their paths.
nlohmann::ordered_json without_folders(nlohmann::ordered_json json, const Stage& stage) {
    if (json.is_structured())
        for (auto& item : json) item = without_folders(item, stage);
    else if (json.is_string())
        for (const auto* paths : {&stage.inputs, &stage.outputs})
            for (const auto& path : *paths)
                if (json == path.string()) return path.filename().string();
    return json;
}

bool outputs_match(const nlohmann::ordered_json& record, const Stage& stage) {
    return std::ranges::all_of(stage.outputs, [&](const std::filesystem::path& output) {
        const std::string name = output.filename().string();
        return std::filesystem::exists(output) && record.at("outputs").value(name, "") == sha256_file(output);
    });
}

// What a child that a signal ended could not say itself.
std::string last_words(const Stage& stage, const ChildResult& child) {
    const int signal = child.exit_code - 128;
    return fmt::format(
        "palpate-{}: was ended by signal {} ({}) after {:.0f} s, having taken {:.0f} MB{}\n", stage.command,
        signal, strsignal(signal), child.seconds, static_cast<double>(child.peak_memory_bytes) / 1e6,
        signal == SIGKILL ? "; as happens where memory runs out: use a coarser mesh or a machine with more"
                          : "");
}

}  // namespace

bool is_lasting(const StageFailure& failure) {
    return failure.exit_code == cli::ExitCode::usage || failure.exit_code == cli::ExitCode::invalid_input ||
           failure.exit_code == cli::ExitCode::quality_not_met;
}

void throw_failure(const std::string& stage_name, int exit_code) {
    const ErrorDetail detail{"stage '" + stage_name + "'",
                             "failed with exit code " + std::to_string(exit_code), "",
                             "mend what it says above and run again; finished stages are kept"};
    switch (exit_code) {
        case cli::ExitCode::usage:
            throw UsageError(detail);
        case cli::ExitCode::invalid_input:
            throw InvalidInput(detail);
        case cli::ExitCode::quality_not_met:
            throw QualityNotMet(detail);
        case cli::ExitCode::interrupted:
            throw cli::Interrupted();
        default:
            throw SystemFailure(detail);
    }
}

std::string content_digest(const std::filesystem::path& path) {
    if (!std::filesystem::is_directory(path)) {
        if (const std::string kind = other_kind(path); !kind.empty())
            throw InvalidInput({path.string(), kind, "a file or a folder", "check the path"});
        return sha256_file(path);
    }
    std::vector<std::filesystem::path> files;
    for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
        if (entry.is_regular_file()) files.push_back(entry.path());
    std::ranges::sort(files);
    std::string listing;
    for (const auto& file : files)
        listing += std::filesystem::relative(file, path).string() + " " + sha256_file(file) + "\n";
    return digest_of_text(listing);
}

StageRunner::StageRunner(std::filesystem::path programs, std::filesystem::path folder, int threads,
                         bool quiet)
    : programs_(std::move(programs)), folder_(std::move(folder)), threads_(threads), quiet_(quiet) {}

std::filesystem::path StageRunner::result_path(const std::string& stage_name) const {
    std::string file = stage_name;
    std::ranges::replace(file, ' ', '-');
    return folder_ / (file + ".json");
}

std::filesystem::path StageRunner::error_path(const std::string& stage_name) const {
    return result_path(stage_name).replace_extension(".error.txt");
}

std::filesystem::path StageRunner::record_path(const std::string& stage_name) const {
    return result_path(stage_name).replace_extension(".stage.json");
}

bool StageRunner::made_by_us(const std::string& stage_name, const std::filesystem::path& output) const {
    const auto record = read_json(record_path(stage_name));
    return record.is_object() &&
           record.at("outputs").value(output.filename().string(), "") == sha256_file(output);
}

std::filesystem::path StageRunner::failure_path(const std::string& stage_name) const {
    return result_path(stage_name).replace_extension(".failure.json");
}

// Everything that decides about a stage's outputs. Folders do not: a build that moved is still up to date.
std::string StageRunner::key_of(const Stage& stage) const {
    std::string text = program_digest(programs_ / ("palpate-" + stage.command)) + "\n" +
                       without_folders(stage.request, stage).dump() + "\n";
    for (const auto& input : stage.inputs) text += content_digest(input) + "\n";
    return digest_of_text(text);
}

std::optional<StageRecord> StageRunner::recorded(const std::string& stage_name) const {
    const auto record = read_json(record_path(stage_name));
    if (!record.is_object()) return std::nullopt;
    return StageRecord{stage_name, false, record.at("seconds"), record.at("peak_memory_bytes"),
                       read_json(result_path(stage_name))};
}

std::optional<StageRecord> StageRunner::finished(Stage stage) const {
    const auto record = read_json(record_path(stage.name));
    if (!record.is_object() || record.value("key", "") != key_of(stage)) return std::nullopt;
    stage.outputs.push_back(result_path(stage.name));
    if (!outputs_match(record, stage)) return std::nullopt;
    return recorded(stage.name);
}

std::optional<StageFailure> StageRunner::failed(const Stage& stage) const {
    const auto failure = read_json(failure_path(stage.name));
    if (!failure.is_object() || failure.value("key", "") != key_of(stage)) return std::nullopt;
    return StageFailure{failure.at("exit_code"), failure.at("said")};
}

nlohmann::ordered_json StageRunner::run_program(const Stage& stage, const std::string& key) const {
    const std::filesystem::path result = result_path(stage.name), error = error_path(stage.name);
    const auto request = std::filesystem::path(result).replace_extension(".request.json");
    cli::write_text_file(request, stage.request.dump(2) + "\n", true);
    std::vector<std::string> arguments{
        "--request", request.string(),         "--force",      "--json",      result.string(),
        "--threads", std::to_string(threads_), "--error-file", error.string()};
    std::filesystem::remove(error);
    std::filesystem::remove(failure_path(stage.name));
    if (quiet_) arguments.emplace_back("--quiet");
    const ChildResult child = run_child(programs_ / ("palpate-" + stage.command), arguments);
    nlohmann::ordered_json record{
        {"key", key}, {"seconds", child.seconds}, {"peak_memory_bytes", child.peak_memory_bytes}};
    if (child.exit_code == 0) return record;
    if (child.exit_code != cli::ExitCode::interrupted) {
        if (!std::filesystem::exists(error) && child.exit_code > 128)
            cli::write_text_file(error, last_words(stage, child), true);
        record["exit_code"] = child.exit_code;
        record["said"] = std::filesystem::exists(error) ? text_of(error) : "";
        cli::write_text_file(failure_path(stage.name), record.dump(2) + "\n", true);
    }
    throw_failure(stage.name, child.exit_code);
}

StageRecord StageRunner::run(Stage stage) const {
    std::filesystem::create_directories(folder_);
    const FolderLock lock(folder_, stage.name);
    if (const auto record = finished(stage)) return *record;
    spdlog::info("{}", stage.name);
    auto record = run_program(stage, key_of(stage));
    stage.outputs.push_back(result_path(stage.name));
    for (const auto& output : stage.outputs)
        record["outputs"][output.filename().string()] = sha256_file(output);
    cli::write_text_file(record_path(stage.name), record.dump(2) + "\n", true);
    return {stage.name, true, record["seconds"], record["peak_memory_bytes"],
            read_json(result_path(stage.name))};
}

}  // namespace palpate::case_builder
