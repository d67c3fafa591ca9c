// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <fmt/format.h>
#include <optional>
#include <spdlog/spdlog.h>

#include "formats/asset/asset.hpp"
#include "formats/asset/hdf5/signature.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"
#include "formats/toml_file/quoted.hpp"
#include "tools/case_builder/cautions.hpp"
#include "tools/case_builder/checks/case_check.hpp"
#include "tools/case_builder/checks/place_check.hpp"
#include "tools/case_builder/folder_lock.hpp"
#include "tools/case_builder/forecast.hpp"
#include "tools/case_builder/kept_case.hpp"
#include "tools/case_builder/overrides.hpp"
#include "tools/case_builder/provenance.hpp"
#include "tools/case_builder/stages.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/software.hpp"

namespace {
using namespace palpate;

nlohmann::ordered_json stages_json(const std::vector<case_builder::StageRecord>& records) {
    nlohmann::ordered_json rows = nlohmann::ordered_json::array();
    for (const case_builder::StageRecord& record : records)
        rows.push_back({{"stage", record.name},
                        {"status", record.ran ? "run" : "up to date"},
                        {"seconds", record.seconds},
                        {"peak_memory_mb", static_cast<double>(record.peak_memory_bytes) / 1e6},
                        {"result", record.result}});
    return rows;
}

void require_our_output(const case_builder::StageRunner& runner, const std::string& stage,
                        const std::filesystem::path& output) {
    if (std::filesystem::exists(output) && !runner.made_by_us(stage, output))
        throw InvalidInput({output.string(), "exists and was not made from these parts", "",
                            "choose another name or pass --force"});
}

void require_asset_name(const std::filesystem::path& output) {
    if (output.extension() != ".vtkhdf")
        throw UsageError({output.string(), "is no name for an asset", "a name that ends in .vtkhdf", ""});
    cli::seekable_target(output);
    if (output.has_parent_path() && !std::filesystem::is_directory(output.parent_path()))
        throw InvalidInput({output.string(), "its folder does not exist", "",
                            "make it first: mkdir -p " + output.parent_path().string()});
}

std::vector<case_builder::Override> overrides_of(const std::vector<std::string>& settings) {
    std::vector<case_builder::Override> overrides;
    for (const std::string& setting : settings)
        overrides.push_back(
            case_builder::parse_override(setting, "--set", static_cast<int>(overrides.size()) + 1));
    return overrides;
}

// What one build is made of.
struct Build {
    const case_builder::CaseFile& case_file;
    const case_builder::BuildPaths& paths;
    const std::vector<case_builder::Stage> stages;
    const case_builder::StageRunner& runner;
};

// A page on what there was before a stage failed. That it cannot be made does not hide why the stage failed.
void show_failure(const Build& build, const case_builder::Stage& failed) {
    try {
        build.runner.run(
            case_builder::failure_stage(build.case_file, build.paths, build.stages, failed, build.runner));
        spdlog::error("{} shows what there is so far", case_builder::failure_page(build.paths).string());
    } catch (const Error& error) {
        spdlog::warn("no page on what there is so far: {}", error.what());
    }
}

case_builder::StageRecord run(const Build& build, const case_builder::Stage& stage) {
    case_builder::prepare(stage, build.case_file, build.paths, build.stages, build.runner);
    try {
        return build.runner.run(stage);
    } catch (const Error&) {
        if (std::filesystem::exists(build.runner.error_path(stage.name))) show_failure(build, stage);
        throw;
    }
}

// While one build is at its parts another waits, for with the same parts it might be of another version of
// the case.
std::vector<case_builder::StageRecord> run_all(const Build& build, case_builder::PlaceCheck& places) {
    const std::filesystem::path& parts = build.paths.parts;
    std::filesystem::create_directories(parts);
    if (case_builder::FolderLock::held_by_another(parts, "build"))
        spdlog::warn("waits for another build in {}", parts.string());
    const case_builder::FolderLock lock(parts, "build");
    std::filesystem::remove(case_builder::failure_page(build.paths));
    std::vector<case_builder::StageRecord> records;
    for (const case_builder::Stage& stage : build.stages) {
        records.push_back(run(build, stage));
        places.after(records.back());
        // A stage that ran has said so itself.
        if (const auto& record = records.back(); !record.ran)
            for (const auto& warning : record.result.value("warnings", nlohmann::ordered_json::array()))
                spdlog::warn("{}", warning.get<std::string>());
    }
    return records;
}

const case_builder::Stage& stage_named(const Build& build, const std::string& name) {
    const auto stage = std::ranges::find(build.stages, name, &case_builder::Stage::name);
    if (stage != build.stages.end()) return *stage;
    std::vector<std::string> names;
    for (const case_builder::Stage& one : build.stages) names.push_back(one.name);
    throw UsageError({"--stage " + name, "is no stage of this case",
                      fmt::format("one of '{}'", fmt::join(names, "', '")), ""});
}

// One stage of the build, whose inputs other runs have made, perhaps beside other stages of it. What failed
// before and would again is not tried.
case_builder::StageRecord run_one(const Build& build, const std::string& name) {
    std::filesystem::create_directories(build.paths.parts);
    const case_builder::FolderLock lock(build.paths.parts, "build", case_builder::FolderLock::Hold::shared);
    const case_builder::Stage& stage = stage_named(build, name);
    case_builder::require_made(stage, build.stages, build.runner);
    case_builder::prepare(stage, build.case_file, build.paths, build.stages, build.runner);
    if (const auto failure = build.runner.failed(stage); failure && case_builder::is_lasting(*failure)) {
        spdlog::error("as before: {}", failure->said);
        case_builder::throw_failure(stage.name, failure->exit_code);
    }
    return run(build, stage);
}

case_builder::KeptBuild read_kept(const std::filesystem::path& original, const std::filesystem::path& again) {
    if (std::filesystem::exists(again) && std::filesystem::equivalent(original, again))
        throw UsageError({again.string(), "is the asset that is to be built again", "another name", ""});
    return case_builder::kept_build(original);
}

// A case may be built again on the inputs that it was built on, to see that it becomes the same, or on
// others.
void tell_what_changed(const std::vector<std::string>& changed, const std::filesystem::path& original) {
    if (changed.empty()) return;
    spdlog::warn("not what {} was built of: {}", original.string(), fmt::join(changed, ", "));
}

nlohmann::ordered_json compared(const std::filesystem::path& again, const std::filesystem::path& original) {
    const std::vector<std::string> different = asset::differences(again, original);
    if (different.empty())
        spdlog::info("{} is {} again, byte for byte in every dataset", again.string(), original.string());
    else
        spdlog::warn("{} differs from {} in {}", again.string(), original.string(),
                     fmt::join(different, ", "));
    return {{"original", original.string()}, {"different", different}};
}

nlohmann::ordered_json forecast(const Build& build, const std::string& name) {
    const case_builder::Stage& stage = stage_named(build, name);
    const double bytes = static_cast<double>(case_builder::peak_memory_forecast(stage, build.runner));
    return {{"stage", stage.name}, {"peak_memory_mb", bytes / 1e6}};
}

}  // namespace

int main(int argc, char** argv) {
    std::filesystem::path case_path, volume, labels, parts, sign, output;
    std::vector<std::string> settings;
    std::string stage_name;
    bool virtual_clock = false, forecast_only = false;
    cli::Command command(
        {.name = "build",
         .summary = "Builds one patient's asset and report from a case file, running only the stages whose "
                    "inputs changed.",
         .examples = {"palpate build pipelines/cases/liver.toml -o liver.vtkhdf",
                      "palpate build nasopharynx.toml --volume patient7.nrrd -o patient7.vtkhdf",
                      "palpate build liver.vtkhdf --labels labels.seg.nrrd -o again.vtkhdf"},
         .notes =
             "Beside OUTPUT.vtkhdf it writes OUTPUT.html and the folder OUTPUT.parts with every "
             "intermediate result. Where a stage fails, OUTPUT.parts/failure.html shows what it said and "
             "slices through what there was by then. --set deformable.liver.mesh.cell_size_mm=8 goes before "
             "what the case file says; an element of an array of tables is called by its name or label. An "
             "asset keeps its case: built again of the same inputs by the same versions, it becomes the same "
             "byte for byte, and what differs is told; inputs that it names lie in its folder or are "
             "given."});
    command.input("case", case_path, "case file (.toml), or an asset (.vtkhdf) whose case is built again")
        .required();
    command.input("--volume", volume, "CT or MRI to use instead of the case file's input.volume");
    command.input("--labels", labels, "label map to use instead of the case file's input.labels");
    command.output("-o,--output", output, "asset (.vtkhdf)").required();
    command.output("--parts", parts, "folder for intermediate results; OUTPUT.parts by default");
    command.input("--sign", sign, "private key (Ed25519, PEM) to sign the asset with");
    command.option("--set", settings,
                   "KEY=VALUE that goes before the case file's own; again for another key");
    const cli::Option stage_option =
        command.option("--stage", stage_name, "run this stage alone, \"mesh liver\", the others being done");
    command
        .flag("--forecast", forecast_only,
              "run nothing, say what memory --stage may take once those before it are done")
        .needs(stage_option);
    command.flag("--virtual-clock", virtual_clock,
                 "press the finished asset as fast as possible and not in real time, for machines that do "
                 "other work");
    return command.run(argc, argv, [&](cli::Session& session) {
        require_asset_name(output);
        if (parts.empty()) parts = std::filesystem::path(output).replace_extension(".parts");
        const case_builder::BuildPaths paths{parts, output,
                                             std::filesystem::path(output).replace_extension(".html")};
        cli::require_folder_target(paths.parts);
        cli::seekable_target(paths.report);
        if (!sign.empty()) require_small_file(sign, asset::most_key_bytes);
        std::optional<case_builder::KeptBuild> kept;
        if (case_builder::is_asset(case_path) && stage_name.empty()) kept = read_kept(case_path, output);
        std::vector<case_builder::Override> overrides = overrides_of(settings);
        for (const auto& [key, file] : {std::pair("volume", volume), std::pair("labels", labels)})
            if (!file.empty())
                overrides.push_back({fmt::format("input.{}", key), toml_file::quoted(file.string()),
                                     fmt::format("--{}", key), 1});
        case_builder::CaseFile case_file = case_builder::read_case_file(case_path, overrides);
        case_file.sign = sign;
        if (kept && kept->series_left_out && case_file.volume_import.series.empty())
            throw UsageError({"--set input.series",
                              "is missing, for the asset does not keep which series was chosen",
                              "its number, UID or description", "'palpate import FOLDER --list' lists them"});
        case_builder::check_case_file(case_path, case_file, overrides);
        case_builder::PlaceCheck places(case_path, case_file, overrides);
        if (stage_name.empty())
            for (const std::string& doubt : case_builder::doubts_of(case_file)) spdlog::warn("{}", doubt);
        if (kept && !session.threads_given) session.threads = kept->threads.value_or(session.threads);
        const case_builder::StageRunner runner(cli::programs_folder(), parts, session.threads, session.quiet);
        if (!session.force) {
            require_our_output(runner, "pack", paths.asset);
            require_our_output(runner, "report", paths.report);
        }
        using case_builder::TouchClock;
        const auto stages =
            stages_of(case_file, paths, virtual_clock ? TouchClock::virtual_time : TouchClock::real);
        const Build build{case_file, paths, stages, runner};
        if (forecast_only) return forecast(build, stage_name);
        const auto changed = kept ? changed_since(*kept, case_file) : std::vector<std::string>();
        tell_what_changed(changed, case_path);
        const auto records =
            stage_name.empty() ? run_all(build, places) : std::vector{run_one(build, stage_name)};
        nlohmann::ordered_json result{{"asset", paths.asset.string()},
                                      {"report", paths.report.string()},
                                      {"stages", stages_json(records)}};
        if (kept && changed.empty()) result["again"] = compared(paths.asset, case_path);
        return result;
    });
}
