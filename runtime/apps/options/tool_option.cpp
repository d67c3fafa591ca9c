// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/options/tool_option.hpp"

#include <algorithm>
#include <spdlog/spdlog.h>
#include <vector>

#include "formats/model/errors.hpp"
#include "formats/stl_file/read_stl.hpp"
#include "runtime/haptics/methods/contact_methods.hpp"
#include "tools/cli/record_options.hpp"
#include "tools/cli/refuse_beside.hpp"

namespace palpate::apps {

void declare(cli::Command& command, ToolOption& option) {
    command.option(
        "--instrument", option.tool,
        "an instrument that turns by itself and gives torque: 'rod', the case's tip and shaft, or "
        "the closed surface that it has (.stl, mm: its tip's centre at the origin, its shaft along "
        "z)");
    cli::record_options(command, tool_fields, option.settings, "of --instrument: ");
}

void check(const cli::Command& command, const ToolOption& option, const std::string& scheme) {
    const haptics::ContactCapabilities& can = haptics::find_contact_method(scheme, "--scheme").can;
    if (!option.tool.empty() && !can.turns)
        throw UsageError({"--instrument", "with --scheme " + scheme, "--scheme continuous or shell",
                          "with no other do tools turn"});
    if (option.has_surface() && !can.has_surface)
        throw UsageError({"--instrument", option.tool + " with --scheme " + scheme,
                          "--scheme shell, or --instrument rod",
                          "no other scheme feels a surface of the tool's own"});
    if (!option.tool.empty()) return;
    std::vector<std::string> settings;
    for_each_field(tool_fields, [&](const auto& field) { settings.push_back(option_name(field.name)); });
    for (const cli::Parameter& parameter : command.parameters())
        if (cli::asked_for(parameter) &&
            std::ranges::find(settings, parameter.option.name()) != settings.end())
            throw UsageError({parameter.option.name(), "without --instrument",
                              "--instrument rod or a file beside it", ""});
}

std::optional<ToolBody> tool_body(const ToolOption& option) {
    if (option.tool.empty()) return std::nullopt;
    return ToolBody{option.has_surface() ? stl_file::read_stl(option.tool) : TriangleMesh{}, option.settings};
}

void tell_misfit(const StatusCounts& statuses, std::int64_t ticks) {
    const auto counts = statuses.by_name();
    const auto inside = counts.find(status_text(starts_inside));
    if (inside != counts.end() && inside->second == ticks)
        spdlog::warn(
            "the tool was inside a body in every tick and felt nothing: it does not fit where it begins; "
            "hold it "
            "otherwise with --shaft or a script of quaternions, or begin elsewhere with --target");
}

void tell_unfelt(const Case& patient_case, const std::string& scheme) {
    if (haptics::find_contact_method(scheme).can.feels_tissue || patient_case.deformable_bodies.empty())
        return;
    std::string names;
    for (const DeformableBody& body : patient_case.deformable_bodies)
        names += (names.empty() ? "'" : ", '") + body.name + "'";
    spdlog::warn("scheme '{}' feels rigid bodies alone: nothing is felt of {}", scheme, names);
}

}  // namespace palpate::apps
