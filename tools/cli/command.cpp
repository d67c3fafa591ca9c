// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/command.hpp"

#include <CLI/CLI.hpp>
#include <algorithm>
#include <cassert>
#include <charconv>
#include <chrono>
#include <cmath>
#include <cstdlib>
#include <fmt/format.h>
#include <iostream>
#include <limits>
#include <new>
#include <nlohmann/json.hpp>
#include <spdlog/sinks/stdout_sinks.h>
#include <spdlog/spdlog.h>
#include <string_view>
#include <sys/resource.h>
#include <thread>
#include <type_traits>
#include <utility>

#include "formats/model/errors.hpp"
#include "formats/model/label_map.hpp"
#include "tools/cli/request_format.hpp"
#include "tools/cli/result_lines.hpp"
#include "tools/cli/slicer_xml.hpp"

namespace palpate::cli {
namespace {

void set_up_logging(const std::string& program, bool quiet, bool verbose) {
    auto logger =
        std::make_shared<spdlog::logger>(program, std::make_shared<spdlog::sinks::stderr_sink_mt>());
    logger->set_pattern("%n: %v");
    logger->set_level(quiet ? spdlog::level::err : verbose ? spdlog::level::debug : spdlog::level::info);
    spdlog::set_default_logger(logger);
}

// What --threads is where it is not given. Tests that run side by side take one each: the threads of OpenBLAS
// wait for one another by turning round, ten times as long as the work takes where there are fewer cores than
// such threads.
int usual_threads() {
    const char* variable = "PALPATE_THREADS";
    const char* set = std::getenv(variable);
    if (set == nullptr || *set == '\0')
        return static_cast<int>(std::max(1U, std::thread::hardware_concurrency()));
    const std::string_view text = set;
    int threads = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), threads);
    if (error != std::errc() || end != text.data() + text.size() || threads < 1)
        throw UsageError(
            {variable, "'" + std::string(text) + "'", "an integer above 0", "unset it for all cores"});
    return threads;
}

std::int64_t peak_memory_bytes() {
    rusage usage{};
    getrusage(RUSAGE_SELF, &usage);
    return std::int64_t{usage.ru_maxrss} * 1024;  // Linux reports KiB
}

// Refuses "nan" and "inf", which CLI11 reads as numbers; an empty text means accepted.
std::string finite_number(const std::string& text) {
    return std::isfinite(std::strtod(text.c_str(), nullptr)) ? "" : text + " is not a finite number";
}

// Likewise of what T does not hold, such as -1, which CLI11 counts back from the largest.
template <typename T>
std::string whole_number(const std::string& text) {
    T value{};
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error == std::errc{} && end == text.data() + text.size()) return "";
    return fmt::format("{} is not a whole number from {} to {}", text, std::numeric_limits<T>::min(),
                       std::numeric_limits<T>::max());
}

// A file's own text must not command the terminal that a message about it is shown on.
std::string without_controls(std::string message) {
    for (char& c : message)
        if (static_cast<unsigned char>(c) < 0x20 && c != '\n' && c != '\t') c = '?';
    return message;
}

void require_there(const std::string& path) {
    std::error_code error;
    if (std::filesystem::exists(path, error)) return;
    throw InvalidInput({path, error ? error.message() : "no such file or folder", "", "check the path"});
}

// As a shell makes of a variable that is not set.
void refuse_empty_path(const std::string& option, const std::vector<std::string>& paths) {
    if (std::ranges::find(paths, "") != paths.end())
        throw UsageError({option, "is given an empty path", "a file name", "leave it out, or name a file"});
}

template <typename T>
nlohmann::ordered_json json_of(const T& value) {
    return value;
}

nlohmann::ordered_json json_of(const std::filesystem::path& path) {
    return path.string();
}

nlohmann::ordered_json json_of(const std::vector<std::filesystem::path>& paths) {
    nlohmann::ordered_json list = nlohmann::ordered_json::array();
    for (const auto& path : paths) list.push_back(path.string());
    return list;
}

template <typename T>
nlohmann::ordered_json json_of(const std::optional<T>& value) {
    return value ? nlohmann::ordered_json(*value) : nlohmann::ordered_json();
}

template <typename T>
std::function<nlohmann::ordered_json()> value_of(const T& variable) {
    return [&variable] { return json_of(variable); };
}

// "max_triangles" for "--max-triangles".
std::string key_from(const Option& option) {
    const std::string key = option.name();
    return identifier(key.substr(key.find_first_not_of('-')));
}

// The arguments, last one first as CLI11 wants them, in which "--max_triangles" is "--max-triangles" where
// the command has that option: 3D Slicer's flags are identifiers. What follows "--" or an option that takes
// a value is no option.
std::vector<std::string> reversed_arguments(const CLI::App& app, int argc, char** argv) {
    std::vector<std::string> words;
    bool options = true, value = false;
    for (int i = 1; i < argc; ++i) {
        std::string word = argv[i];
        options = options && (value || word != "--");
        if (options && !value && word.starts_with("--")) {
            const std::string name = word.substr(0, word.find('='));
            std::string dashed = name;
            std::ranges::replace(dashed, '_', '-');
            if (app.get_option_no_throw(name) == nullptr && app.get_option_no_throw(dashed) != nullptr)
                word.replace(0, name.size(), dashed);
        }
        const CLI::Option* const option = options && !value ? app.get_option_no_throw(word) : nullptr;
        value = option != nullptr && word.starts_with('-') && option->get_items_expected_min() > 0;
        words.push_back(std::move(word));
    }
    std::ranges::reverse(words);
    return words;
}

std::string help_footer(const CommandText& text) {
    std::string footer = "Examples:\n";
    for (const std::string& example : text.examples) footer += "  " + example + "\n";
    if (!text.notes.empty()) footer += "\n" + text.notes + "\n";
    return footer +
           "\nPositions are LPS mm. Exit codes: 0 ok, 1 failed, 2 usage, 3 invalid input, "
           "4 quality contract not met, 130 interrupted.";
}

}  // namespace

std::string version() {
    return PALPATE_VERSION;
}

std::string identifier(std::string name) {
    std::ranges::replace(name, '-', '_');
    return name;
}

Command::Command(CommandText text)
    : text_(std::move(text)), app_(std::make_unique<CLI::App>(text_.summary, "palpate " + text_.name)) {
    app_->option_defaults()->always_capture_default(false);
    app_->footer(help_footer(text_));
    app_->set_version_flag("--version", "palpate " + version());
    const std::string group = "Every command";
    app_->add_option("--json", json_path_, "write the result as JSON to this file, '-' for stdout")
        ->group(group);
    app_->add_option("--error-file", error_path_, "where it fails, write its message to this file as well")
        ->group(group);
    app_->add_flag("--quiet", quiet_, "say nothing but errors")->group(group);
    app_->add_flag("--verbose", verbose_, "say more")->group(group);
    app_->add_flag("--force", force_, "replace existing outputs")->group(group);
    app_->set_config("--request", "",
                     "take options from this JSON file, such as a build leaves in OUTPUT.parts")
        ->group(group);
    app_->config_formatter(std::make_shared<RequestFormat>(*this));
    app_->allow_config_extras(CLI::config_extras_mode::error);
    app_->add_flag("--xml")
        ->description("print the Slicer Execution Model description and exit")
        ->group(group);
    app_->add_option("--threads", threads_,
                     "threads for work that can use several [default: $PALPATE_THREADS, or all cores]")
        ->check(positive_number, "POSITIVE")
        ->group(group);
}

Command::~Command() = default;

Option Command::remember(Parameter::Kind kind, Option option, const std::string& help, const std::string& key,
                         std::function<nlohmann::ordered_json()> value) {
    const std::string unset = value().dump();
    parameters_.push_back(
        {kind, option, help, key.empty() ? key_from(option) : key, std::move(value), unset});
    return option;
}

Option Command::input(const std::string& names, std::filesystem::path& value, const std::string& help) {
    return remember(Parameter::Kind::input_file, Option(app_->add_option(names, value, help)), help, "",
                    value_of(value));
}

Option Command::input(const std::string& names, std::vector<std::filesystem::path>& values,
                      const std::string& help) {
    return remember(Parameter::Kind::input_file, Option(app_->add_option(names, values, help)), help, "",
                    value_of(values));
}

Option Command::output(const std::string& names, std::filesystem::path& value, const std::string& help) {
    return remember(Parameter::Kind::output_file, Option(app_->add_option(names, value, help)), help, "",
                    value_of(value));
}

Option Command::flag(const std::string& names, bool& value, const std::string& help) {
    return remember(Parameter::Kind::flag, Option(app_->add_flag(names, value, help)), help, "",
                    value_of(value));
}

template <typename T>
Option Command::option(const std::string& names, T& value, const std::string& help, const std::string& unit,
                       const std::string& key) {
    const std::string full_help = unit.empty() ? help : help + " [" + unit + "]";
    CLI::Option* const option = app_->add_option(names, value, full_help);
    auto kind = Parameter::Kind::text;
    if constexpr (std::is_floating_point_v<T>) {
        kind = Parameter::Kind::number;
        option->default_str(fmt::format("{}", value))->check(finite_number);
    } else if constexpr (std::is_same_v<T, std::optional<double>>) {
        kind = Parameter::Kind::number;
        option->check(finite_number);
    } else if constexpr (std::is_integral_v<T>) {
        kind = Parameter::Kind::integer;
        option->default_str(fmt::format("{}", value))->check(whole_number<T>);
    } else if constexpr (std::is_same_v<T, std::string>) {
        if (!value.empty()) option->default_str(value);
    }
    return remember(kind, Option(option), full_help, key, value_of(value));
}

Option Command::items(const std::string& names, ItemList list, const std::string& help,
                      const std::string& unit, const std::string& key) {
    const std::string full_help = unit.empty() ? help : help + " [" + unit + "]";
    const std::function<void(const std::vector<std::string>&)> read = list.read;
    CLI::Option* const option = app_->add_option_function<std::vector<std::string>>(names, read, full_help);
    return remember(Parameter::Kind::text, Option(option), full_help, key, std::move(list.write));
}

nlohmann::ordered_json Command::request() const {
    nlohmann::ordered_json request = nlohmann::ordered_json::object();
    for (const Parameter& parameter : parameters_)
        if (auto value = parameter.value(); value.dump() != parameter.unset)
            request[parameter.key] = std::move(value);
    return request;
}

const std::string& Command::key_of(const std::string& option) const {
    const auto found = std::ranges::find_if(
        parameters_, [&](const Parameter& parameter) { return parameter.option.name() == option; });
    assert(found != parameters_.end());
    return found->key;
}

template Option Command::option(const std::string&, double&, const std::string&, const std::string&,
                                const std::string&);
template Option Command::option(const std::string&, int&, const std::string&, const std::string&,
                                const std::string&);
template Option Command::option(const std::string&, std::int64_t&, const std::string&, const std::string&,
                                const std::string&);
template Option Command::option(const std::string&, std::uint64_t&, const std::string&, const std::string&,
                                const std::string&);
template Option Command::option(const std::string&, std::optional<std::uint64_t>&, const std::string&,
                                const std::string&, const std::string&);
template Option Command::option(const std::string&, std::optional<double>&, const std::string&,
                                const std::string&, const std::string&);
template Option Command::option(const std::string&, std::string&, const std::string&, const std::string&,
                                const std::string&);
template Option Command::option(const std::string&, std::vector<double>&, const std::string&,
                                const std::string&, const std::string&);
template Option Command::option(const std::string&, std::vector<std::string>&, const std::string&,
                                const std::string&, const std::string&);

int Command::parse(int argc, char** argv) {
    // Not left to CLI11: --xml must work without the required arguments.
    for (int i = 1; i < argc; ++i)
        if (std::string_view(argv[i]) == "--xml") {
            std::cout << slicer_xml(*this);
            return ExitCode::ok;
        }
    try {
        app_->parse(reversed_arguments(*app_, argc, argv));
        return -1;
    } catch (const CLI::CallForHelp&) {
        std::cout << app_->help();
        return ExitCode::ok;
    } catch (const CLI::CallForVersion&) {
        std::cout << "palpate " << version() << '\n';
        return ExitCode::ok;
    } catch (const CLI::ExtrasError& error) {
        std::vector<std::string> known;
        for (const CLI::Option* option : app_->get_options()) known.push_back(option->get_name());
        std::cerr << "palpate-" << text_.name << ": " << error.what();
        for (const std::string& extra : app_->remaining()) {
            const auto near = nearest_names(extra, known);
            if (extra.starts_with("-") && !near.empty())
                std::cerr << "; did you mean " << near.front() << "?";
        }
        std::cerr << '\n';
    } catch (const CLI::FileError&) {
        throw InvalidInput(
            {app_->get_option("--request")->as<std::string>(), "no such file", "", "check the path"});
    } catch (const CLI::ParseError& error) {
        std::cerr << "palpate-" << text_.name << ": " << error.what() << "; see 'palpate " << text_.name
                  << " --help'\n";
    }
    return ExitCode::usage;
}

void Command::emit(nlohmann::ordered_json result, const Session& session, double seconds,
                   StagedFile* json_file) const {
    result["schema"] = "palpate." + text_.name + (session.form.empty() ? "" : "." + session.form) + "/1";
    result["version"] = version();
    result["seconds"] = seconds;
    result["peak_memory_bytes"] = peak_memory_bytes();
    if (json_file != nullptr) {
        json_file->write_text(result.dump(2) + "\n");
        json_file->commit();
    } else if (json_path_ == "-") {
        std::cout << result.dump(2) << '\n';
    } else if (!stdout_is_taken() || !quiet_) {
        std::ostream& told = stdout_is_taken() ? std::cerr : std::cout;
        if (session.text.empty())
            print_result(result, told);
        else
            told << session.text;
    }
}

int Command::run(int argc, char** argv, const std::function<nlohmann::ordered_json(Session&)>& job) {
    const std::string program = "palpate-" + text_.name;
    const auto start = std::chrono::steady_clock::now();
    std::optional<StagedFile> error_file;
    const auto stage_error_file = [&] {  // once, for what is refused is told on stderr alone
        if (!error_path_.empty()) error_file.emplace(std::exchange(error_path_, ""), force_);
    };
    const auto say = [&](const std::string& message) {
        const std::string text = program + ": " + without_controls(with_final_names(message)) + "\n";
        std::cerr << text;
        try {
            stage_error_file();
            if (!error_file) return;
            error_file->write_text(text);
            error_file->commit();
        } catch (const std::exception& error) {
            std::cerr << program << ": " << with_final_names(error.what()) << '\n';
        }
    };
    remove_staged_files_on_interrupt();
    try {
        if (const int code = parse(argc, argv); code >= 0) {
            flush_stdout();
            return code;
        }
        set_up_logging(program, quiet_, verbose_);
        for (const char* const option : {"--json", "--error-file"})
            refuse_empty_path(option, app_->get_option(option)->results());
        stage_error_file();
        for (const Parameter& parameter : parameters_)
            if (parameter.kind == Parameter::Kind::input_file ||
                parameter.kind == Parameter::Kind::output_file)
                refuse_empty_path(parameter.option.name(), parameter.option.words());
        for (const Parameter& parameter : parameters_)
            if (parameter.kind == Parameter::Kind::input_file)
                for (const std::string& path : parameter.option.words()) require_there(path);
        Session session;
        session.threads = threads_ > 0 ? threads_ : usual_threads();
        session.threads_given = threads_ > 0;
        session.force = force_;
        session.quiet = quiet_;
        session.json = !json_path_.empty();
        session.progress = Progress(quiet_);
        std::optional<StagedFile> json_file;
        if (json_path_ == "-") take_stdout_as("--json -");
        if (!json_path_.empty() && json_path_ != "-") json_file.emplace(json_path_, force_);
        nlohmann::ordered_json result = job(session);
        session.progress.finish();
        emit(std::move(result), session,
             std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count(),
             json_file ? &*json_file : nullptr);
        flush_stdout();
        if (session.shortfall) throw QualityNotMet(*session.shortfall);
        return ExitCode::ok;
    } catch (const UsageError& error) {
        say(error.what());
        return ExitCode::usage;
    } catch (const InvalidInput& error) {
        say(error.what());
        return ExitCode::invalid_input;
    } catch (const QualityNotMet& error) {
        say(error.what());
        return ExitCode::quality_not_met;
    } catch (const Interrupted&) {
        return ExitCode::interrupted;
    } catch (const std::bad_alloc&) {
        say("out of memory; use a coarser mesh or a machine with more memory");
    } catch (const std::filesystem::filesystem_error& error) {
        say(error.path1().string() + ": " + error.code().message() + "; check the path");
    } catch (const std::exception& error) {
        say(error.what());
    }
    return ExitCode::failed;
}

}  // namespace palpate::cli
