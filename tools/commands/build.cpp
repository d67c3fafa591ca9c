// SPDX-License-Identifier: GPL-3.0-or-later
#include <spdlog/spdlog.h>

#include "formats/model/errors.hpp"
#include "tools/case_builder/case_check.hpp"
#include "tools/case_builder/cautions.hpp"
#include "tools/case_builder/stages.hpp"
#include "tools/cli/command.hpp"

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

// A page on what there was before a stage failed. That it cannot be made does not hide why the stage failed.
void show_failure(const case_builder::CaseFile& case_file, const case_builder::BuildPaths& paths,
                  const std::vector<case_builder::StageRecord>& records,
                  const case_builder::StageRunner& runner, const std::filesystem::path& error_file) {
    try {
        runner.run(case_builder::failure_stage(case_file, paths, records, error_file));
        spdlog::error("{} shows what there is so far", case_builder::failure_page(paths).string());
    } catch (const Error& error) {
        spdlog::warn("no page on what there is so far: {}", error.what());
    }
}

std::vector<case_builder::StageRecord> make_asset(const case_builder::CaseFile& case_file,
                                                  const case_builder::BuildPaths& paths,
                                                  const case_builder::StageRunner& runner) {
    std::filesystem::remove(case_builder::failure_page(paths));
    std::vector<case_builder::StageRecord> records;
    for (const case_builder::Stage& stage : case_builder::stages_to_asset(case_file, paths)) {
        try {
            records.push_back(runner.run(stage));
        } catch (const Error&) {
            const auto error_file = runner.error_path(stage.name);
            if (std::filesystem::exists(error_file))
                show_failure(case_file, paths, records, runner, error_file);
            throw;
        }
    }
    return records;
}

}  // namespace

int main(int argc, char** argv) {
    std::filesystem::path case_path, volume, labels, parts, output;
    cli::Command command(
        {.name = "build",
         .summary = "Builds one patient's asset and report from a case file, running only the stages whose "
                    "inputs changed.",
         .examples = {"palpate build pipelines/cases/liver.toml -o liver.vtkhdf",
                      "palpate build nasopharynx.toml --volume patient7.nrrd -o patient7.vtkhdf"},
         .notes =
             "Beside OUTPUT.vtkhdf it writes OUTPUT.html and the folder OUTPUT.parts with every "
             "intermediate result. Where a stage fails, OUTPUT.parts/failure.html shows what it said and "
             "slices through what there was by then."});
    command.input("case", case_path, "case file (.toml)").required();
    command.input("--volume", volume, "CT or MRI to use instead of the case file's input.volume");
    command.input("--labels", labels, "label map to use instead of the case file's input.labels");
    command.output("-o,--output", output, "asset (.vtkhdf)").required();
    command.output("--parts", parts, "folder for intermediate results; OUTPUT.parts by default");
    return command.run(argc, argv, [&](cli::Session& session) {
        if (output.extension() != ".vtkhdf")
            throw UsageError({output.string(), "is no name for an asset", "a name that ends in .vtkhdf", ""});
        if (output.has_parent_path() && !std::filesystem::is_directory(output.parent_path()))
            throw InvalidInput({output.string(), "its folder does not exist", "",
                                "make it first: mkdir -p " + output.parent_path().string()});
        case_builder::CaseFile case_file = case_builder::read_case_file(case_path);
        if (!volume.empty()) case_file.volume = volume;
        if (!labels.empty()) case_file.labels = labels;
        case_builder::check_case_file(case_path, case_file);
        for (const std::string& doubt : case_builder::doubts_of(case_file)) spdlog::warn("{}", doubt);
        if (parts.empty()) parts = std::filesystem::path(output).replace_extension(".parts");
        const case_builder::BuildPaths paths{parts, output,
                                             std::filesystem::path(output).replace_extension(".html")};
        const case_builder::StageRunner runner(std::filesystem::read_symlink("/proc/self/exe").parent_path(),
                                               parts, session.threads, session.quiet);
        if (!session.force) {
            require_our_output(runner, "pack", paths.asset);
            require_our_output(runner, "report", paths.report);
        }
        std::vector<case_builder::StageRecord> records = make_asset(case_file, paths, runner);
        records.push_back(runner.run(case_builder::touch_stage(paths)));
        records.push_back(
            runner.run(case_builder::report_stage(case_file, paths, records, runner.result_path("touch"))));
        return nlohmann::ordered_json{{"asset", paths.asset.string()},
                                      {"report", paths.report.string()},
                                      {"stages", stages_json(records)}};
    });
}
