// SPDX-License-Identifier: Apache-2.0
#include "runtime/apps/options/large_option.hpp"

#include <algorithm>

#include "formats/model/errors.hpp"
#include "runtime/haptics/methods/contact_methods.hpp"

namespace palpate::apps {

void declare_large_deformation(cli::Command& command, std::vector<std::string>& bodies) {
    command.option(
        "--large-deformation", bodies,
        "deformable bodies by name, 'all' or 'none', whose tissue is neo-Hookean instead of linear: solved "
        "beside the tick, right where tissue is deformed by more than a few per cent of its size; as the "
        "asset says if not given");
}

void check_large_deformation(const std::vector<std::string>& bodies, const std::string& scheme) {
    const bool none = std::ranges::find(bodies, "none") != bodies.end();
    if (none && bodies.size() > 1)
        throw UsageError({"--large-deformation", "'none' beside others", "'none' alone, or bodies", ""});
    if (!bodies.empty() && !none && !haptics::find_contact_method(scheme, "--scheme").can.deforms_far)
        throw UsageError(
            {"--large-deformation", "with --scheme " + scheme, "--scheme continuous", "no other knows it"});
}

}  // namespace palpate::apps
