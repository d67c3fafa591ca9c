// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <CLI/CLI.hpp>
#include <filesystem>
#include <fmt/format.h>
#include <functional>
#include <nlohmann/json.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/errors.hpp"
#include "tools/cli/progress.hpp"
#include "tools/cli/staged_file.hpp"

namespace palpate::cli {

/// The version that --version prints and results carry.
std::string version();

/// Exit codes of every command.
enum ExitCode : int {
    ok = 0,
    failed = 1,
    usage = 2,
    invalid_input = 3,
    quality_not_met = 4,
    interrupted = 130
};

/// A child process was interrupted, so this command is too (exit code 130).
struct Interrupted {};

/// What a command says of itself.
struct CommandText {
    std::string name;                   ///< "mesh" for palpate-mesh
    std::string summary;                ///< one sentence, verb first
    std::vector<std::string> examples;  ///< two command lines
    std::string notes;                  ///< further help: formats, units, sources; may be empty
};

/// One option as the help and the Slicer description know it.
struct Parameter {
    enum class Kind { input_file, output_file, number, integer, text, flag };
    Kind kind;
    CLI::Option* option;
    std::string help;
};

/// What one run of a command may use.
struct Session {
    int threads = 1;     ///< --threads
    bool force = false;  ///< --force: existing outputs may be replaced
    bool quiet = false;  ///< --quiet
    Progress progress;   ///< talks on stderr, silent with --quiet
    /// Set by a job whose result is worth printing though a contract is not met: exit code 4.
    std::optional<ErrorDetail> shortfall;
    /// Set by a job that has something better for a person to read than lines "name value".
    std::string text;

    /// Opens an output that appears whole at commit() or not at all; an existing file without --force throws
    /// InvalidInput.
    StagedFile stage(const std::filesystem::path& path) const { return StagedFile(path, force); }
};

/// A command: its options, its help, and the one place that turns exceptions into messages and exit codes.
///
///     int main(int argc, char** argv) {
///         cli::Command command({.name = "obb", .summary = "Builds ...", .examples = {..., ...}});
///         std::filesystem::path input, output;
///         command.input("surface", input, "triangles (.vtp), LPS mm")->required();
///         command.output("-o,--output", output, "OBB tree (.obb.h5)")->required();
///         return command.run(argc, argv, [&](cli::Session& session) { ...; return Json{...}; });
///     }
class Command {
  public:
    explicit Command(CommandText text);

    CLI::App& app() { return app_; }

    /// Adds a positional ("surface") or named ("--labels") input file; its existence is checked by run().
    CLI::Option* input(const std::string& names, std::filesystem::path& value, const std::string& help);
    CLI::Option* output(const std::string& names, std::filesystem::path& value, const std::string& help);
    CLI::Option* flag(const std::string& names, bool& value, const std::string& help);

    /// Adds a number, a text or a list of either. `unit` ("mm", "kPa", "" for none) and the default, which is
    /// the present content of `value`, are part of the help.
    template <typename T>
    CLI::Option* option(const std::string& names, T& value, const std::string& help,
                        const std::string& unit = "") {
        const std::string full_help = unit.empty() ? help : help + " [" + unit + "]";
        CLI::Option* option = app_.add_option(names, value, full_help);
        if constexpr (std::is_floating_point_v<T>) {
            option->default_str(fmt::format("{}", value))->check(finite_number);
            return remember(Parameter::Kind::number, option, full_help);
        } else if constexpr (std::is_integral_v<T>) {
            option->default_str(fmt::format("{}", value));
            return remember(Parameter::Kind::integer, option, full_help);
        } else {
            if constexpr (std::is_convertible_v<T, std::string>)
                if (!value.empty()) option->default_str(value);
            return remember(Parameter::Kind::text, option, full_help);
        }
    }

    /// Parses, runs `job`, writes its JSON result to stdout (as lines "name value", or as JSON with --json),
    /// and returns the exit code. `job` returns an object; run() adds schema, version, seconds and peak
    /// memory.
    int run(int argc, char** argv, const std::function<nlohmann::ordered_json(Session&)>& job);

    const CommandText& text() const { return text_; }
    const std::vector<Parameter>& parameters() const { return parameters_; }

  private:
    /// Refuses "nan" and "inf", which CLI11 reads as numbers; an empty text means accepted.
    static std::string finite_number(const std::string& text);
    CLI::Option* remember(Parameter::Kind kind, CLI::Option* option, const std::string& help);
    int parse(int argc, char** argv);
    void emit(nlohmann::ordered_json result, const std::string& text, double seconds,
              StagedFile* json_file) const;

    CommandText text_;
    CLI::App app_;
    std::vector<Parameter> parameters_;
    std::string json_path_;
    bool quiet_ = false;
    bool verbose_ = false;
    bool force_ = false;
    int threads_ = 0;
};

}  // namespace palpate::cli
