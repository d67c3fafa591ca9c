// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/cohort/cohort_page.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <map>

#include "tools/report/charts.hpp"
#include "tools/report/html.hpp"
#include "tools/report/page_style.hpp"

namespace palpate::cohort {
namespace {

namespace html = report::html;

std::string bytes_of(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

// One for each patient; none of those who are not whole, whose figures compare with nothing.
std::vector<std::optional<double>> column(std::span<const PatientResult> results, std::size_t figure) {
    std::vector<std::optional<double>> values;
    for (const PatientResult& result : results)
        values.push_back(result.outcome == Outcome::built ? result.figures[figure] : std::nullopt);
    return values;
}

std::string link(const std::filesystem::path& target, const std::filesystem::path& page_folder,
                 const std::string& text) {
    if (!std::filesystem::exists(target)) return "";
    return fmt::format("<a href=\"{}\">{}</a>",
                       html::escaped(target.lexically_relative(page_folder).generic_string()), text);
}

std::string picture(const PatientResult& result) {
    const std::string png = bytes_of(result.paths.parts / "thumbnail.png");
    if (png.empty() || result.outcome != Outcome::built) return "";
    return fmt::format("<img width=\"95\" alt=\"{}\" src=\"{}\">", html::escaped(result.patient),
                       html::data_uri("image/png", png));
}

std::string status(const PatientResult& result) {
    const std::filesystem::path folder = result.paths.asset.parent_path();
    if (result.outcome == Outcome::built) return link(result.paths.report, folder, "report");
    std::string text = name_of(result.outcome);
    if (!result.failed_stage.empty()) text += " at " + html::escaped(result.failed_stage);
    const std::string page = result.failed_stage.empty()
                                 ? ""
                                 : link(result.paths.parts / "failure.html", folder, "what there was");
    return "<strong class=\"bad\">" + text + "</strong>" + (page.empty() ? "" : "<br>" + page);
}

std::string patients_section(std::span<const PatientResult> results) {
    std::vector<html::Column> columns{{""}, {"Patient"}, {"Status"}};
    std::vector<std::vector<std::optional<double>>> values;
    std::vector<std::vector<bool>> apart;
    for (std::size_t f = 0; f < figures().size(); ++f) {
        columns.push_back(
            {figures()[f].name + std::string(*figures()[f].unit ? ", " : "") + figures()[f].unit, true});
        apart.push_back(outliers(values.emplace_back(column(results, f))));
    }
    std::vector<std::vector<std::string>> rows;
    for (std::size_t i = 0; i < results.size(); ++i) {
        std::vector<std::string> row{picture(results[i]), html::escaped(results[i].patient),
                                     status(results[i])};
        for (std::size_t f = 0; f < figures().size(); ++f) {
            const auto& value = values[f][i];
            const std::string text = value ? html::significant(*value, 4) : "–";
            row.push_back(apart[f][i] ? "<strong class=\"bad\" title=\"stands apart\">◆ " + text + "</strong>"
                                      : text);
        }
        rows.push_back(std::move(row));
    }
    return html::section(
        "patients", "Patients",
        "◆ marks a value more than 3.5 robust standard deviations from the cohort's median, of "
        "five patients or more (Iglewicz and Hoaglin 1993).",
        html::table(columns, rows));
}

std::string failures_section(std::span<const PatientResult> results) {
    std::vector<std::vector<std::string>> rows;
    for (const PatientResult& result : results)
        if (result.outcome == Outcome::failed)
            rows.push_back({html::escaped(result.patient), html::escaped(result.failed_stage),
                            html::escaped(result.said)});
    if (rows.empty()) return "";
    return html::section("failures", "Failures", "What failed, in its own words, and what to do about it.",
                         html::table({{"Patient"}, {"Stage"}, {"What it said"}}, rows));
}

// Twenty bins from the smallest value to the largest.
report::BinCounts histogram(const std::vector<std::optional<double>>& values) {
    constexpr std::size_t bins = 20;
    report::BinCounts counts{.low = INFINITY, .high = -INFINITY, .counts = std::vector<std::int64_t>(bins)};
    for (const auto& value : values)
        if (value) {
            counts.low = std::min(counts.low, *value);
            counts.high = std::max(counts.high, *value);
        }
    if (counts.high <= counts.low) counts.high = counts.low + std::max(1e-12, std::abs(counts.low) * 0.01);
    for (const auto& value : values)
        if (value) {
            const double part = (*value - counts.low) / (counts.high - counts.low);
            ++counts.counts[std::min(bins - 1, static_cast<std::size_t>(part * bins))];
        }
    return counts;
}

std::string distributions_section(std::span<const PatientResult> results) {
    std::string charts;
    for (std::size_t f = 0; f < figures().size(); ++f) {
        const auto values = column(results, f);
        if (std::ranges::none_of(values, [](const auto& value) { return value.has_value(); })) continue;
        const Figure& figure = figures()[f];
        charts += html::figure(report::histogram_svg(histogram(values), figure.name,
                                                     *figure.unit ? std::string(" ") + figure.unit : "", 4),
                               html::escaped(figure.name));
    }
    if (charts.empty()) return "";
    return html::section("distributions", "Distributions", "Patients by each figure.",
                         "<div class=\"three\">\n" + charts + "</div>\n");
}

std::string stages_section(std::span<const PatientResult> results) {
    struct Cost {
        std::int64_t count = 0;
        double seconds = 0, longest = 0;
        std::int64_t memory = 0;
    };
    std::map<std::string, Cost> costs;
    for (const PatientResult& result : results)
        for (std::size_t i = 0; i < result.stages.size(); ++i)
            if (const auto& record = result.states[i].record) {
                Cost& cost = costs[result.stages[i]];
                ++cost.count;
                cost.seconds += record->seconds;
                cost.longest = std::max(cost.longest, record->seconds);
                cost.memory = std::max(cost.memory, record->peak_memory_bytes);
            }
    if (costs.empty()) return "";
    std::vector<std::vector<std::string>> rows;
    for (const auto& [stage, cost] : costs)
        rows.push_back({html::escaped(stage), html::grouped(cost.count), fmt::format("{:.1f}", cost.seconds),
                        fmt::format("{:.2f}", cost.seconds / static_cast<double>(cost.count)),
                        fmt::format("{:.2f}", cost.longest), html::grouped(cost.memory / 1'000'000)});
    return html::section("stages", "Time and memory", "What the finished stages took when they ran last.",
                         html::table({{"Stage"},
                                      {"Patients", true},
                                      {"All, s", true},
                                      {"Mean, s", true},
                                      {"Longest, s", true},
                                      {"Peak memory, MB", true}},
                                     rows));
}

}  // namespace

std::string cohort_page(const std::string& name, std::span<const PatientResult> results) {
    const auto count = [&](Outcome outcome) {
        return html::grouped(std::ranges::count(results, outcome, &PatientResult::outcome));
    };
    const std::string title = html::escaped(name);
    const std::string failures = failures_section(results), distributions = distributions_section(results),
                      stages = stages_section(results);
    std::string navigation = "<a href=\"#patients\">Patients</a>";
    if (!failures.empty()) navigation += "<a href=\"#failures\">Failures</a>";
    if (!distributions.empty()) navigation += "<a href=\"#distributions\">Distributions</a>";
    if (!stages.empty()) navigation += "<a href=\"#stages\">Time and memory</a>";
    return "<!DOCTYPE html>\n<html lang=\"en\">\n<head>\n<meta charset=\"utf-8\">\n"
           "<meta name=\"viewport\" content=\"width=device-width,initial-scale=1\">\n<title>" +
           title + " – Palpate cohort</title>\n<style>" + std::string(report::page_style) +
           "main{max-width:1480px}td a{color:var(--accent)}td "
           "img{display:block}.bad{color:var(--bad)}</style>\n</head>\n<body>\n<main>\n<header>\n"
           "<p class=\"kind\">Palpate cohort</p>\n<h1>" +
           title + "</h1>\n" +
           html::cards({{"Patients", html::grouped(std::ssize(results)), ""},
                        {"Built", count(Outcome::built), ""},
                        {"Failed", count(Outcome::failed), ""},
                        {"Unfinished", count(Outcome::unfinished), ""}}) +
           "</header>\n<nav>" + navigation + "</nav>\n" + failures + patients_section(results) +
           distributions + stages +
           "<footer>Not a medical device; not for diagnosis or "
           "treatment.</footer>\n</main>\n</body>\n</html>\n";
}

}  // namespace palpate::cohort
