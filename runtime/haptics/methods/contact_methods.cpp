// SPDX-License-Identifier: Apache-2.0
#include "runtime/haptics/methods/contact_methods.hpp"

#include <algorithm>
#include <array>
#include <vector>

#include "formats/model/errors.hpp"
#include "formats/records/shown_text.hpp"
#include "runtime/haptics/methods/continuous_contact.hpp"
#include "runtime/haptics/methods/gap_contact.hpp"
#include "runtime/haptics/methods/published_contact.hpp"
#include "runtime/haptics/methods/shell_contact.hpp"
#include "runtime/haptics/methods/solid_contact.hpp"

namespace palpate::haptics {
namespace {

using Tested = PublishedContact::Tested;
using Face = PublishedContact::Face;

constexpr ContactCapabilities of_published{.most_tools = 1};

constexpr std::array table{
    ContactMethodEntry{"single", shown_text("is published: inside or outside at 30 Hz decides"), of_published,
                       make_published<Tested::single, Face::kept>},
    ContactMethodEntry{
        "twice",
        shown_text("is published: the same, with a second test of the last position between two detections"),
        of_published, make_published<Tested::twice, Face::kept>},
    ContactMethodEntry{"single-renewed",
                       shown_text("is `single` read otherwise: every detection renews the face in contact"),
                       of_published, make_published<Tested::single, Face::renewed>},
    ContactMethodEntry{"twice-renewed", shown_text("is `twice` read so"), of_published,
                       make_published<Tested::twice, Face::renewed>},
    ContactMethodEntry{
        "continuous",
        shown_text("is ours: every tick sweeps the tool from the last to the present position"),
        {.has_radius = true,
         .spreads_loads = true,
         .deforms_far = true,
         .sums_rigid_walls = true,
         .creeps = true,
         .turns = true,
         .keeps_energy = true},
        make_continuous},
    ContactMethodEntry{
        "shell",
        shown_text("is published: a whole tool that turns, as points against voxels of rigid bodies"),
        {.has_radius = true,
         .feels_tissue = false,
         .turns = true,
         .always_turns = true,
         .samples_surface = true,
         .gives_way = true},
        make_shell},
    ContactMethodEntry{
        "cones",
        shown_text("is published: a whole tool that turns, pushed off by every local minimum of its distance "
                   "from rigid bodies"),
        {.has_radius = true, .feels_tissue = false, .turns = true, .always_turns = true, .gives_way = true},
        make_cones},
    ContactMethodEntry{
        "features",
        shown_text("is published: a whole tool that turns, pushed off by the closest features of its convex "
                   "pieces and those of rigid bodies"),
        {.has_radius = true, .feels_tissue = false, .turns = true, .always_turns = true, .gives_way = true},
        make_features},
    ContactMethodEntry{
        "solid",
        shown_text("is ours: a whole tool that turns, its triangles never through those of rigid bodies"),
        {.has_radius = true, .feels_tissue = false, .turns = true, .always_turns = true},
        make_solid},
};

// "one, two or three": of those whose capabilities serve.
template <typename Serves>
std::string names_of(const Serves& serves) {
    std::vector<std::string> names;
    for (const ContactMethodEntry& method : table)
        if (serves(method.can)) names.emplace_back(method.name);
    std::string text;
    for (std::size_t i = 0; i < names.size(); ++i)
        text += (i == 0 ? "" : i + 1 == names.size() ? " or " : ", ") + names[i];
    return text;
}

}  // namespace

std::span<const ContactMethodEntry> contact_methods() {
    return table;
}

const ContactMethodEntry& find_contact_method(std::string_view name, const std::string& culprit) {
    const auto* found = std::ranges::find(table, name, &ContactMethodEntry::name);
    if (found == table.end()) throw UsageError({culprit, std::string(name), contact_method_names(), ""});
    return *found;
}

std::string contact_method_names(std::size_t tool_count) {
    return names_of([&](const ContactCapabilities& can) { return can.most_tools >= tool_count; });
}

std::string contact_method_names(bool ContactCapabilities::*can) {
    return names_of([&](const ContactCapabilities& of) { return of.*can; });
}

std::string contact_method_sentences() {
    std::string text;
    for (const ContactMethodEntry& method : table)
        text += (text.empty() ? "'" : "; '") + std::string(method.name) + "' " + std::string(method.sentence);
    return text;
}

}  // namespace palpate::haptics
