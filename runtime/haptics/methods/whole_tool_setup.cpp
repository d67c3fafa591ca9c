// SPDX-License-Identifier: Apache-2.0
#include "formats/model/errors.hpp"
#include "runtime/haptics/methods/whole_tool_contact.hpp"
#include "runtime/haptics/whole_tool/rod.hpp"

namespace palpate::haptics {

WholeToolContact::WholeToolContact(const ContactBodies& bodies, const ToolSettings& settings,
                                   std::size_t tool_count)
    : bodies_(bodies), settings_(settings) {
    tools_.resize(tool_count);
    for (Tool& tool : tools_) tool.hints.assign(bodies.rigid_count(), -1);
}

WholeToolContact::~WholeToolContact() = default;

TriangleMesh tool_surface(const Case& patient_case, std::size_t most_triangles) {
    TriangleMesh surface = has_instrument(patient_case)
                               ? patient_case.tool->surface
                               : rod_surface(patient_case.haptics.tool_radius, rod_length(patient_case));
    if (surface.triangles.size() > most_triangles)
        throw InvalidInput({"instrument", std::to_string(surface.triangles.size()) + " triangles",
                            std::to_string(most_triangles) + " or fewer",
                            "simplify its surface, or use contact method 'shell'"});
    return surface;
}

ToolSettings whole_tool_settings(const Case& patient_case, const std::string& method) {
    if (patient_case.rigid_bodies.empty())
        throw InvalidInput({patient_case.name,
                            "no rigid body, and contact method '" + method + "' feels no other",
                            "a case with rigid anatomy", "use contact method 'continuous'"});
    return patient_case.tool ? patient_case.tool->settings : ToolSettings{};
}

}  // namespace palpate::haptics
