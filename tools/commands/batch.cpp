// SPDX-License-Identifier: GPL-3.0-or-later
// palpate batch: builds all patients of a table, or of a BIDS dataset, and shows them on one page.
#include <algorithm>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <map>
#include <set>
#include <spdlog/spdlog.h>
#include <sstream>

#include "formats/model/errors.hpp"
#include "tools/case_builder/folder_lock.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/software.hpp"
#include "tools/cohort/bids/bids_table.hpp"
#include "tools/cohort/cohort.hpp"
#include "tools/cohort/cohort_page.hpp"
#include "tools/cohort/plan.hpp"
#include "tools/cohort/snakemake.hpp"

namespace {

using namespace palpate;
using namespace palpate::cohort;

// What the command line names.
struct BatchRequest {
    std::filesystem::path table, case_file, output;
    BidsChoice choice;
};

// Writes the table of a BIDS dataset, but not over one that somebody edited.
void keep_table(const std::filesystem::path& file, const std::string& text, const BatchRequest& request,
                bool force) {
    if (std::ifstream stream(file); stream) {
        const std::string kept{std::istreambuf_iterator<char>(stream), {}};
        if (kept == text) return;
        if (!force)
            throw InvalidInput({file.string(),
                                "is not the table that " + request.table.string() + " gives now", "",
                                fmt::format("build it as it stands with 'palpate batch {} -o {}', or pass "
                                            "--force to write it anew",
                                            file.string(), request.output.string())});
    }
    std::filesystem::create_directories(file.parent_path());
    cli::write_text_file(file, text, true);
}

// The cohort of a table, or of a BIDS dataset, whose table goes into the cohort's folder if it is kept; what
// is relative to that folder can be looked for only if there is one.
Cohort cohort_of_request(const BatchRequest& request, bool keep, bool force) {
    if (!std::filesystem::is_directory(request.table))
        return cohort_of(read_patient_table(request.table), request.table, request.output);
    const CohortFolder folder{std::filesystem::weakly_canonical(std::filesystem::absolute(request.output))};
    const std::string text =
        bids_patient_table(request.table, request.case_file, keep ? folder.root : std::filesystem::path(),
                           request.choice, [](std::string_view said) { spdlog::warn("{}", said); });
    if (keep) {
        refuse_while_built(folder);
        keep_table(folder.bids_table(), text, request, force);
    }
    std::istringstream stream(text);
    return cohort_of(parse_patient_table(stream, folder.bids_table()), folder.bids_table(), folder.root);
}

// Tells how far patients and stages are.
class Bar {
  public:
    Bar(const Cohort& cohort, const States& states, cli::Progress& progress) : progress_(progress) {
        for (std::size_t i = 0; i < states.size(); ++i) {
            const auto to_do = stages_to_do(cohort.builds[i], states[i]);
            const auto count = std::ranges::count(to_do, true);
            if (count > 0) left_[cohort.builds[i].patient.name] = count;
            stages_ += count;
        }
        patients_ = left_.size();
    }
    std::int64_t stages() const { return stages_; }

    void show(const JobEvent& event) {
        if (event.kind == JobEvent::Kind::started) return;
        const bool failed = event.kind == JobEvent::Kind::failed;
        if (failed) {
            failed_.insert(event.patient);
        } else {
            ++finished_;
            if (--left_[event.patient] == 0) left_.erase(event.patient);
        }
        progress_.step(
            fmt::format("{} of {} patients, {} of {} stages{}; {}: {}{}", patients_ - left_.size(), patients_,
                        finished_, stages_,
                        failed_.empty() ? "" : fmt::format(", failed patients: {}", failed_.size()),
                        event.patient, event.stage, failed ? " failed" : ""),
            static_cast<double>(finished_) / static_cast<double>(stages_));
    }

  private:
    cli::Progress& progress_;
    std::map<std::string, std::int64_t> left_;  // stages of each patient
    std::size_t patients_ = 0;
    std::int64_t finished_ = 0, stages_ = 0;
    std::set<std::string> failed_;
};

// Only what is not finished goes to Snakemake, with fresh stamps, so that nothing but digests decides.
std::int64_t run_what_is_to_do(const Cohort& cohort, const States& states, const SnakemakeRun& run,
                               cli::Session& session) {
    Bar bar(cohort, states, session.progress);
    if (bar.stages() == 0) return 0;
    std::filesystem::remove_all(cohort.folder.done());
    for (std::size_t i = 0; i < states.size(); ++i)
        if (std::ranges::count(stages_to_do(cohort.builds[i], states[i]), true) > 0)
            std::filesystem::remove(failure_page(cohort.builds[i].paths));
    cli::write_text_file(
        cohort.folder.plan(),
        plan_of(cohort.builds, states, cohort.folder, cohort.table.parent_path(), cli::programs_folder())
                .dump(1) +
            "\n",
        true);
    run_snakemake(run, cohort.folder, [&](const JobEvent& event) { bar.show(event); });
    session.progress.finish();
    return bar.stages();
}

std::vector<PatientResult> write_results(const Cohort& cohort, States states) {
    std::vector<PatientResult> results;
    for (std::size_t i = 0; i < states.size(); ++i) {
        results.push_back(result_of(cohort.builds[i], std::move(states[i])));
        if (cohort.builds[i].patient.named)
            cli::write_text_file(cohort.folder.status_of(results[i].patient),
                                 status_json(results[i]).dump(2) + "\n", true);
    }
    cli::write_text_file(cohort.folder.results(), results_table(results), true);
    cli::write_text_file(cohort.folder.benchmarks(), stages_table(results), true);
    cli::write_text_file(cohort.folder.page(), cohort_page(cohort.table.stem().string(), results), true);
    return results;
}

nlohmann::ordered_json result_json(const Cohort& cohort, std::span<const PatientResult> results,
                                   std::int64_t stages) {
    nlohmann::ordered_json patients = nlohmann::ordered_json::array();
    for (const PatientResult& result : results)
        patients.push_back({{"patient", result.patient},
                            {"status", name_of(result.outcome)},
                            {"failed_stage", result.failed_stage},
                            {"said", result.said}});
    return {{"page", cohort.folder.page().string()},
            {"table", cohort.folder.results().string()},
            {"stages_to_do", stages},
            {"patients", patients}};
}

nlohmann::ordered_json build_cohort(const Cohort& cohort, const SnakemakeRun& run, cli::Session& session) {
    std::filesystem::create_directories(cohort.folder.batch());
    std::filesystem::create_directories(cohort.folder.snakemake_log().parent_path());
    refuse_while_built(cohort.folder);
    const case_builder::FolderLock lock(cohort.folder.batch(), "batch");
    write_requests(cohort);
    std::int64_t stages = 0;
    bool interrupted = false;
    const auto states = [&] {
        States found = states_of_all(cohort, cli::programs_folder(),
                                     [&](double done) { session.progress.step("comparing digests", done); });
        session.progress.finish();
        return found;
    };
    try {
        stages = run_what_is_to_do(cohort, states(), run, session);
    } catch (const cli::Interrupted&) {
        interrupted = true;
    }
    const auto results = write_results(cohort, states());
    session.text = summary_text(results) + cohort.folder.page().string() + "\n";
    if (interrupted) {
        spdlog::error("interrupted; run the same command again to go on");
        throw cli::Interrupted();
    }
    const auto built = std::ranges::count(results, Outcome::built, &PatientResult::outcome);
    if (built < std::ssize(results))
        session.shortfall = ErrorDetail{
            cohort.table.string(), fmt::format("{} of {} patients were built", built, results.size()), "all",
            "mend what is said above and run again; finished stages are kept. " +
                cohort.folder.snakemake_log().string() + " says the rest"};
    return result_json(cohort, results, stages);
}

nlohmann::ordered_json check_cohort(const Cohort& cohort) {
    const auto mistaken = std::ranges::count_if(
        cohort.builds, [](const PatientBuild& build) { return !build.patient.mistake.empty(); });
    if (mistaken > 0)
        throw InvalidInput({cohort.table.string(),
                            fmt::format("{} of {} patients cannot be built", mistaken, cohort.builds.size()),
                            "", "mend what is said above"});
    return {{"table", cohort.table.string()}, {"patients", cohort.builds.size()}};
}

}  // namespace

int main(int argc, char** argv) {
    BatchRequest request;
    std::string profile = "local";
    bool check = false, requests = false;
    cli::Command command(
        {.name = "batch",
         .summary = "Builds every patient of a table side by side and shows them on one page.",
         .examples = {"palpate batch patients.tsv -o cohort",
                      "palpate batch patients.tsv -o cohort --profile slurm",
                      "palpate batch bids/ --case liver.toml -o cohort"},
         .notes =
             "The table is separated by tabs: patient, case and, where a patient differs from the case file, "
             "volume, labels, label_names or a case file's key such as deformable.liver.mesh.cell_size_mm; "
             "paths are relative to the table. Of a BIDS dataset it is made, with a row for each subject or "
             "session, and kept as OUTPUT/patients.tsv. OUTPUT gets an asset, a report and a status (.json) "
             "for each patient, index.html, results.tsv, stages.tsv and logs. One patient's failure stops no "
             "other; exit code 4 says that not all were built. Run again, only stages whose inputs changed "
             "run, also after an interrupt or a kill. Needs Snakemake."});
    command.input("table", request.table, "patients (.tsv), or the folder of a BIDS dataset").required();
    command.output("-o,--output", request.output, "folder for the cohort").required();
    const cli::Option case_option =
        command.input("--case", request.case_file, "of a BIDS dataset: case file (.toml) of all patients");
    const std::vector<cli::Option> bids_options{
        case_option,
        command.option("--image", request.choice.image,
                       "of a BIDS dataset: which image, as T2w or acq-mprage_T1w [default: the suffix that "
                       "most subjects have]"),
        command.option("--segmentation", request.choice.segmentation,
                       "of a BIDS dataset: which *_dseg.nii.gz where there are several, as seg-organs"),
        command.input("--derivatives", request.choice.derivatives,
                      "of a BIDS dataset: the folder that has the segmentations [default: all in its "
                      "derivatives/]")};
    command.option("--profile", profile,
                   "where stages run: local, slurm, or a folder with a Snakemake profile");
    const cli::Option check_option =
        command.flag("--check", check, "check the table and all case files, build nothing");
    command
        .flag("--requests", requests,
              "write for each patient what 'palpate build --request' takes to OUTPUT/.batch/requests, for a "
              "scheduler of your own, and build nothing")
        .excludes(check_option);
    return command.run(argc, argv, [&](cli::Session& session) {
        const bool dataset = std::filesystem::is_directory(request.table);
        if (dataset && !case_option.given())
            throw UsageError({request.table.string(), "is a folder without --case",
                              "a BIDS dataset and the case file of its patients, or a table",
                              "draft one with 'palpate init'"});
        for (const cli::Option& option : bids_options)
            if (!dataset && option.given())
                throw UsageError({option.name(), "with a table", "a BIDS dataset",
                                  "a table names case files, images and label maps itself"});
        cli::require_folder_target(request.output);
        const Cohort cohort = cohort_of_request(request, !check, session.force);
        for (const PatientBuild& build : cohort.builds)
            if (!build.patient.mistake.empty())
                spdlog::error("{}: {}", build.patient.name, build.patient.mistake);
        if (check) return check_cohort(cohort);
        if (requests) {
            write_requests(cohort);
            return nlohmann::ordered_json{{"requests", (cohort.folder.batch() / "requests").string()}};
        }
        const SnakemakeRun run{
            std::filesystem::weakly_canonical(cli::programs_folder() / "../share/palpate/pipelines"), profile,
            session.threads};
        return build_cohort(cohort, run, session);
    });
}
