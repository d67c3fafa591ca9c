// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/report/html.hpp"
#include "tools/report/sections.hpp"

namespace palpate::report {
namespace {

using html::escaped;

std::string text_of(const nlohmann::json& value) {
    if (value.is_string()) return escaped(value.get<std::string>());
    if (value.is_number_float()) return html::significant(value.get<double>(), 4);
    if (value.is_number_integer()) return html::grouped(value.get<std::int64_t>());
    return escaped(value.dump());
}

// Rows "a.b  value" of a nested object, in its own order.
void flatten(const nlohmann::json& json, const std::string& prefix,
             std::vector<std::vector<std::string>>& rows) {
    for (const auto& [key, value] : json.items()) {
        const std::string name = prefix.empty() ? key : prefix + "." + key;
        if (value.is_structured() && !value.empty())
            flatten(value, name, rows);
        else
            rows.push_back({escaped(name), "<span class=\"mono\">" + text_of(value) + "</span>"});
    }
}

struct TouchFigure {
    const char* pointer;
    const char* name;
    const char* unit;
    const char* meaning;
};

constexpr TouchFigure touch_figures[] = {
    {"/ready_s", "Ready after", " s", "From launch to the first force that could be felt."},
    {"/ticks", "Ticks", "", "One every millisecond: read the device, find the contact, send the force."},
    {"/overruns", "Overruns", "", "Milliseconds in which no tick began, because the machine was late."},
    {"/force_peak_n", "Peak force", " N", "The largest force sent to the hand."},
    {"/force_step_max_n", "Largest step", " N", "The largest change of force from one tick to the next."},
    {"/penetration/device_mm", "Device below the surface", " mm",
     "How far the hand pressed in, measured from the surface at rest."},
    {"/penetration/tool_mm", "Tool below the surface", " mm",
     "What is left of that once rigid surfaces held the tool and tissue gave way: the error of the contact."},
};

std::string percentiles(const nlohmann::json& touch) {
    std::vector<std::vector<std::string>> rows;
    for (const auto& [key, name] :
         {std::pair{"tick_us", "Time of a tick"}, std::pair{"wake_latency_us", "Wake-up latency"}}) {
        if (!touch.contains(key)) continue;
        std::vector<std::string> row{name};
        for (const char* part : {"p50", "p99", "p99_9", "max"})
            row.push_back(touch[key].contains(part) ? text_of(touch[key][part]) : "–");
        rows.push_back(row);
    }
    if (rows.empty()) return "";
    return html::table({{"Microseconds"}, {"p50", true}, {"p99", true}, {"p99.9", true}, {"max", true}},
                       rows);
}

}  // namespace

std::string touch_section(const ReportPage& page) {
    const ReportInputs& inputs = page.inputs;
    std::string content;
    if (!inputs.force_curve_svg.empty())
        content += html::figure("<div class=\"chart\"><img alt=\"Force over time\" src=\"" +
                                    html::data_uri("image/svg+xml", inputs.force_curve_svg) + "\"></div>",
                                "Force over the run.");
    else
        content += html::missing(
            "No force curve was given. <code>palpate touch --curve force.svg</code> draws one, "
            "<code>palpate report --curve force.svg</code> shows it.");
    if (!inputs.touch) {
        content += html::missing(
            "No touch statistics were given. <code>palpate touch --json stats.json</code> measures them, "
            "<code>palpate report --touch stats.json</code> shows them.");
        return html::section("touch", "Touch", "", content);
    }
    const nlohmann::json& touch = *inputs.touch;
    std::vector<std::vector<std::string>> rows;
    for (const TouchFigure& figure : touch_figures)
        if (const nlohmann::json::json_pointer at(figure.pointer); touch.contains(at))
            rows.push_back({figure.name, text_of(touch[at]) + figure.unit, figure.meaning});
    content += html::table({{"Figure"}, {"Value", true}, {"What it tells"}}, rows) + percentiles(touch);
    return html::section("touch", "Touch", "A recorded run of the 1 kHz loop on this case.", content);
}

std::vector<StageRecord> stages_from_json(const nlohmann::json& json, const std::string& culprit) {
    const std::string expected =
        R"([{"stage": "mesh wall", "seconds": 3.2, "peak_memory_bytes": 123, "status": "run"}, ...])";
    if (!json.is_array()) throw InvalidInput({culprit, "not an array", expected, ""});
    std::vector<StageRecord> stages;
    for (const nlohmann::json& record : json) try {
            stages.push_back({record.at("stage"), record.at("seconds"), record.at("peak_memory_bytes"),
                              record.value("status", "run")});
        } catch (const nlohmann::json::exception&) {
            throw InvalidInput(
                {culprit, fmt::format("record {} is {}", stages.size(), record.dump()), expected, ""});
        }
    return stages;
}

std::string stages_section(const ReportPage& page) {
    const std::vector<StageRecord>& stages = page.inputs.stages;
    if (stages.empty())
        return html::section(
            "stages", "Stages", "",
            html::missing("No stage times were given. <code>palpate build</code> writes them, "
                          "<code>--stages stages.json</code> shows them."));
    double seconds = 0;
    std::int64_t peak = 0;
    for (const StageRecord& stage : stages) {
        seconds += stage.seconds;
        peak = std::max(peak, stage.peak_memory_bytes);
    }
    return html::section(
        "stages", "Stages",
        fmt::format(
            "{:.1f} s in all; peak memory {} MB. Each bar is the wall time of a stage when it last ran.",
            seconds, html::grouped((peak + 500'000) / 1'000'000)),
        html::figure(stages_svg(stages), ""));
}

std::string provenance_section(const ReportPage& page) {
    const std::string& provenance = page.inputs.patient_case.provenance;
    nlohmann::json json = nlohmann::json::parse(provenance, nullptr, false);
    if (json.is_object()) json.erase("meshes");  // contract_section() shows them
    std::string content;
    if (provenance.empty()) {
        content = html::missing("The asset carries no provenance.");
    } else if (json.is_structured()) {
        std::vector<std::vector<std::string>> rows;
        flatten(json, "", rows);
        content = html::table({{"What"}, {"Value"}}, rows);
    } else {
        content = "<p class=\"mono\">" + escaped(provenance) + "</p>\n";
    }
    return html::section("provenance", "Provenance",
                         "Versions, options and input digests as the asset records them.", content);
}

}  // namespace palpate::report
