// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/stage_runner.hpp"

#include <algorithm>
#include <fstream>
#include <span>
#include <spdlog/spdlog.h>

#include "formats/asset/hdf5/digest.hpp"
#include "formats/model/errors.hpp"
#include "tools/case_builder/child_process.hpp"
#include "tools/cli/command.hpp"

namespace palpate::case_builder {
namespace {

using namespace asset;

std::string digest_of_text(const std::string& text) {
    return sha256(std::as_bytes(std::span(text)));
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

// Everything that decides about a stage's outputs. Folders do not: a build that moved is still up to date.
std::string key_of(const Stage& stage, const std::filesystem::path& program) {
    std::string text = sha256_file(program) + "\n" + without_folders(stage.request, stage).dump() + "\n";
    for (const auto& input : stage.inputs) text += content_digest(input) + "\n";
    return digest_of_text(text);
}

bool outputs_match(const nlohmann::ordered_json& record, const Stage& stage) {
    return std::ranges::all_of(stage.outputs, [&](const std::filesystem::path& output) {
        const std::string name = output.filename().string();
        return std::filesystem::exists(output) && record.at("outputs").value(name, "") == sha256_file(output);
    });
}

[[noreturn]] void fail(const Stage& stage, int exit_code) {
    const ErrorDetail detail{"stage '" + stage.name + "'",
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

}  // namespace

std::string content_digest(const std::filesystem::path& path) {
    if (!std::filesystem::is_directory(path)) return sha256_file(path);
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

StageRecord StageRunner::run(Stage stage) const {
    const std::filesystem::path program = programs_ / ("palpate-" + stage.command);
    const std::filesystem::path result = result_path(stage.name), record_file = record_path(stage.name);
    const std::string key = key_of(stage, program);
    stage.outputs.push_back(result);
    auto record = read_json(record_file);
    const bool up_to_date =
        record.is_object() && record.value("key", "") == key && outputs_match(record, stage);
    if (!up_to_date) {
        spdlog::info("{}", stage.name);
        std::filesystem::create_directories(folder_);
        const auto request = std::filesystem::path(result).replace_extension(".request.json");
        cli::write_text_file(request, stage.request.dump(2) + "\n", true);
        std::vector<std::string> arguments{"--request",
                                           request.string(),
                                           "--force",
                                           "--json",
                                           result.string(),
                                           "--threads",
                                           std::to_string(threads_),
                                           "--error-file",
                                           error_path(stage.name).string()};
        std::filesystem::remove(error_path(stage.name));
        if (quiet_) arguments.emplace_back("--quiet");
        const ChildResult child = run_child(program, arguments);
        if (child.exit_code != 0) fail(stage, child.exit_code);
        record = {{"key", key}, {"seconds", child.seconds}, {"peak_memory_bytes", child.peak_memory_bytes}};
        for (const auto& output : stage.outputs)
            record["outputs"][output.filename().string()] = sha256_file(output);
        cli::write_text_file(record_file, record.dump(2) + "\n", true);
    }
    return {stage.name, !up_to_date, record["seconds"], record["peak_memory_bytes"], read_json(result)};
}

}  // namespace palpate::case_builder
