// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/options/tool_option.hpp"

#include <algorithm>
#include <cmath>
#include <spdlog/spdlog.h>
#include <vector>

#include "formats/model/errors.hpp"
#include "formats/model/regions.hpp"
#include "formats/stl_file/read_stl.hpp"
#include "runtime/devices/device_model.hpp"
#include "runtime/devices/jaws/grasp_script.hpp"
#include "runtime/haptics/methods/contact_methods.hpp"
#include "runtime/session/hand_script.hpp"
#include "tools/cli/record_options.hpp"
#include "tools/cli/refuse_beside.hpp"

namespace palpate::apps {
namespace {

bool is_asked_for(const cli::Command& command, const std::string& name) {
    return std::ranges::any_of(command.parameters(), [&](const cli::Parameter& parameter) {
        return cli::asked_for(parameter) && parameter.option.name() == name;
    });
}

// Settings of what is not held.
template <typename Fields>
void refuse_settings(const cli::Command& command, const Fields& fields, const std::string& found,
                     const std::string& expected) {
    std::vector<std::string> settings;
    for_each_field(fields, [&](const auto& field) { settings.push_back(option_name(field.name)); });
    for (const cli::Parameter& parameter : command.parameters())
        if (cli::asked_for(parameter) &&
            std::ranges::find(settings, parameter.option.name()) != settings.end())
            throw UsageError({parameter.option.name(), found, expected, ""});
}

}  // namespace

void declare(cli::Command& command, ToolOption& option) {
    command.option(
        "--instrument", option.tool,
        "an instrument that turns by itself and gives torque: 'rod', the case's tip and shaft, or "
        "the closed surface that it has (.stl, mm: its tip's centre at the origin, its shaft along "
        "z); or 'forceps', two jaws that take hold of tissue");
    cli::record_options(command, tool_fields, option.settings, "of --instrument: ");
    cli::record_options(command, jaw_fields, option.jaws, "of --instrument forceps: ");
}

void check(const cli::Command& command, const ToolOption& option, const std::string& scheme) {
    using namespace haptics;
    const ContactCapabilities& can = find_contact_method(scheme, "--scheme").can;
    if (option.has_jaws() && !(can.turns && can.feels_tissue))
        throw UsageError({"--instrument", "forceps with --scheme " + scheme, "--scheme continuous",
                          "no other feels jaws"});
    if (!option.tool.empty() && !option.has_jaws() && !can.turns)
        throw UsageError({"--instrument", "with --scheme " + scheme,
                          "--scheme " + contact_method_names(&ContactCapabilities::turns),
                          "with no other do tools turn"});
    if (option.has_surface() && !can.samples_surface)
        for (const std::string name : {"--shell-points", "--voxel"})
            if (is_asked_for(command, name))
                throw UsageError(
                    {name, "with --scheme " + scheme, "--scheme shell beside it", "no other samples a tool"});
    if (option.has_surface() && !can.gives_way && is_asked_for(command, "--contact-stiffness"))
        throw UsageError({"--contact-stiffness", "with --scheme " + scheme,
                          "--scheme " + contact_method_names(&ContactCapabilities::gives_way) + " beside it",
                          "with no other do touches give way"});
    if (option.tool.empty() || option.has_jaws())
        refuse_settings(command, tool_fields,
                        option.has_jaws() ? "with --instrument forceps" : "without --instrument",
                        "--instrument rod or a file beside it");
    if (!option.has_jaws())
        refuse_settings(command, jaw_fields, "without --instrument forceps",
                        "--instrument forceps beside it");
    if (const auto error = first_error(jaw_fields, option.jaws))
        throw UsageError({option_name(error->name), error->found, error->expected, ""});
}

void check_hand(const ToolOption& option, const std::string& script, const session::DeviceChoice& device,
                const std::string& second) {
    const std::string grasp(devices::grasp_script), with = " with --instrument forceps";
    if (!option.has_jaws() && script == grasp)
        throw UsageError({"--script", script, "--instrument forceps beside it", ""});
    if (!option.has_jaws()) return;
    if (device.tool_count != 1)
        throw UsageError({"--device", device.text + with, "one device", "it holds both jaws"});
    if (!second.empty()) throw UsageError({"--second", "with --instrument forceps", "", "leave it out"});
    if (session::is_made_to_measure(script) && script != grasp)
        throw UsageError({"--script", script + with, grasp + " or a file", ""});
}

std::optional<ToolBody> tool_body(const ToolOption& option) {
    if (option.tool.empty() || option.has_jaws()) return std::nullopt;
    return ToolBody{option.has_surface() ? stl_file::read_stl(option.tool) : TriangleMesh{}, option.settings};
}

std::optional<JawSettings> jaws_of(const ToolOption& option) {
    return option.has_jaws() ? std::optional(option.jaws) : std::nullopt;
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

void tell_torque(const haptics::HapticModel& model, const std::string& device) {
    if (model.turns() && !model.torque_is_felt())
        spdlog::info("'{}' renders no torque: that of the tool is shown and recorded, and not felt", device);
}

void tell_too_weak(const Case& patient_case, const std::string& device) {
    const devices::DeviceModel* model = devices::model_of_device(device);
    if (!model) return;
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        if (!body.feel) continue;
        for (const FeltRegion& felt : body.feel->regions) {
            const double depth = body.feel->depth, lost = model->coulomb_friction;
            if (verdict_of(felt, depth, lost) != FeltVerdict::too_weak) continue;
            const double change = std::abs(felt.stiffness - felt.stiffness_without);  // N/mm
            spdlog::warn(
                "'{}' changes the force on a press of {:g} mm by {:.2g} N, and the joints of a {} lose {:g} "
                "N: it "
                "is felt from {:.0f} mm on, or by a device with less friction",
                region_name(body.mesh, felt.region), depth, change * depth,
                model->heir.empty() ? model->product : model->heir, lost, std::ceil(lost / change));
        }
    }
}

}  // namespace palpate::apps
