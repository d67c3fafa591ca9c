// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <functional>
#include <memory>
#include <nlohmann/json_fwd.hpp>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/errors.hpp"
#include "tools/cli/item_list.hpp"
#include "tools/cli/option.hpp"
#include "tools/cli/outputs/staged_file.hpp"
#include "tools/cli/progress.hpp"

namespace CLI {
class App;
}

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

/// One option as the help, the Slicer description and request files know it.
struct Parameter {
    enum class Kind { input_file, output_file, number, integer, text, flag };
    Kind kind;
    Option option;
    std::string help;
    std::string key;                                ///< in request files: "cell_size_mm"
    std::function<nlohmann::ordered_json()> value;  ///< of the variable, at present
    std::string unset;                              ///< that value before anything was read, as JSON text
};

/// A name as an identifier: "max_triangles" for "max-triangles".
std::string identifier(std::string name);

/// What one run of a command may use.
struct Session {
    int threads = 1;  ///< --threads, or the variable PALPATE_THREADS, or all cores
    bool threads_given = false;
    bool force = false;  ///< --force: existing outputs may be replaced
    bool quiet = false;  ///< --quiet
    bool json = false;   ///< --json: the result is for a program
    Progress progress;   ///< talks on stderr, silent with --quiet
    /// Set by a job whose result is worth printing though a contract is not met: exit code 4.
    std::optional<ErrorDetail> shortfall;
    /// Set by a job whose result has several forms: "volume" makes its schema "palpate.<command>.volume/1".
    std::string form;
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
///
/// What the options say can come from a file as well, `--request FILE.json`: one JSON object whose keys are
/// the options' names with '_' for '-' ("max_triangles") or the key that an option was given
/// ("cell_size_mm"). Rules and errors are the same; an option on the command line goes before the file's.
class Command {
  public:
    explicit Command(CommandText text);
    ~Command();

    /// Adds a positional ("surface") or named ("--labels") input file, or several; run() checks that they
    /// exist.
    Option input(const std::string& names, std::filesystem::path& value, const std::string& help);
    Option input(const std::string& names, std::vector<std::filesystem::path>& values,
                 const std::string& help);
    Option output(const std::string& names, std::filesystem::path& value, const std::string& help);
    Option flag(const std::string& names, bool& value, const std::string& help);

    /// Adds a number, a text or a list of either; command.cpp lists the types. `unit` ("mm", "kPa", "" for
    /// none) and the default, which is the present content of `value`, are part of the help. `key` is its
    /// name in request files if that is another than the option's.
    template <typename T>
    Option option(const std::string& names, T& value, const std::string& help, const std::string& unit = "",
                  const std::string& key = "");

    /// Adds a list of records, each a word on the command line and a JSON object in a request file; see
    /// item_list().
    Option items(const std::string& names, ItemList list, const std::string& help,
                 const std::string& unit = "", const std::string& key = "");

    /// The present values of all variables that are not as they were when they were added, under their keys:
    /// what `--request` reads.
    nlohmann::ordered_json request() const;

    /// The key in request files of an option, "--cell-size". Precondition: there is such an option.
    const std::string& key_of(const std::string& option) const;

    /// Parses, runs `job`, writes its JSON result to stdout (as lines "name value", or as JSON with --json),
    /// and returns the exit code. Where an output goes to stdout the lines go to stderr. `job` returns an
    /// object; run() adds schema, version, seconds and peak memory.
    int run(int argc, char** argv, const std::function<nlohmann::ordered_json(Session&)>& job);

    const CommandText& text() const { return text_; }
    const std::vector<Parameter>& parameters() const { return parameters_; }

  private:
    Option remember(Parameter::Kind kind, Option option, const std::string& help, const std::string& key,
                    std::function<nlohmann::ordered_json()> value);
    int parse(int argc, char** argv);
    void emit(nlohmann::ordered_json result, const Session& session, double seconds,
              StagedFile* json_file) const;

    CommandText text_;
    std::unique_ptr<CLI::App> app_;
    std::vector<Parameter> parameters_;
    std::string json_path_, error_path_;
    bool quiet_ = false;
    bool verbose_ = false;
    bool force_ = false;
    int threads_ = 0;
};

}  // namespace palpate::cli
