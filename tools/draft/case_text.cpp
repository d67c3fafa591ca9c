// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cctype>
#include <fmt/format.h>

#include "formats/toml_file/quoted.hpp"
#include "tools/draft/case_draft.hpp"
#include "tools/imaging/voxels/hounsfield.hpp"

namespace palpate::draft {
namespace {

// Bodies name files.
std::string body_name(const std::string& label) {
    std::string name = label;
    std::ranges::replace_if(
        name, [](unsigned char c) { return std::isalnum(c) == 0 && c != '_' && c != '-'; }, '_');
    return name;
}

std::string region_text(const DraftRegion& region) {
    std::string text = fmt::format("\n[[deformable.region]]\nlabel = {}\n", toml_file::quoted(region.label));
    text += region.tissue.empty()
                ? "# No preset is known for it: these are a liver's. Put in what you know.\n"
                  "youngs_modulus_kpa = 6.3\npoissons_ratio = 0.45\n"
                : fmt::format("tissue = {}\n", toml_file::quoted(region.tissue));
    if (region.mesh_region > 0) text += fmt::format("mesh_region = {}\n", region.mesh_region);
    if (region.cell_size > 0) text += fmt::format("cell_size_mm = {:g}\n", region.cell_size);
    return text;
}

std::string held_text(const CaseDraft& draft) {
    if (draft.held_by.empty() && draft.held_along)
        return fmt::format(
            "# Held is {}, all along,\n# for it is too long to be held at one end.\n"
            "fixed = [{{ facing = [{:.3f}, {:.3f}, {:.3f}] }}]\n",
            draft.why_held, draft.held_towards.x(), draft.held_towards.y(), draft.held_towards.z());
    if (draft.held_by.empty())
        return fmt::format(
            "# Held is {}:\n# what lies beyond this plane, a point and the way to go.\n"
            "fixed = [{{ plane_mm = [{:.1f}, {:.1f}, {:.1f}, {:.3f}, {:.3f}, {:.3f}] }}]\n",
            draft.why_held, draft.held_at.x(), draft.held_at.y(), draft.held_at.z(), draft.held_towards.x(),
            draft.held_towards.y(), draft.held_towards.z());
    std::string rules;
    for (const std::string& label : draft.held_by)
        rules += fmt::format("{}{{ touching = {} }}", rules.empty() ? "" : ", ", toml_file::quoted(label));
    return fmt::format("# Held is {}.\nfixed = [{}]\n", draft.why_held, rules);
}

std::string rigid_text(const DraftRigid& body) {
    return fmt::format(
        "[[rigid]]\nname = {}\nlabel = {}\n{}\n", toml_file::quoted(body_name(body.label)),
        toml_file::quoted(body.label),
        body.by_grey_values ? fmt::format("isovalue_hu = {:.1f}\n", imaging::bone_from_hu) : "");
}

}  // namespace

std::string case_text(const CaseDraft& draft) {
    std::string text = fmt::format(
        "# A first draft: it builds as it is, and waits for what you know better. Positions are LPS mm.\n"
        "schema = 1\nname = {}\n{}",
        toml_file::quoted(body_name(draft.name)), draft.input.empty() ? "" : "\n[input]\n" + draft.input);
    for (const DraftStructure& structure : draft.structures)
        text += fmt::format("\n# {}\n[[structure]]\nname = {}\n{}", structure.why,
                            toml_file::quoted(structure.name), structure.recipe);
    text += fmt::format("\n[[deformable]]\nname = {}\n{}{}", toml_file::quoted(body_name(draft.name)),
                        draft.mesh, held_text(draft));
    for (const DraftRegion& region : draft.regions) text += region_text(region);
    if (!draft.rigid.empty())
        text += "\n# Neighbours that do not give way; make one [[deformable]] if it should.\n";
    for (const DraftRigid& body : draft.rigid) text += rigid_text(body);
    text += fmt::format("{}[haptics]\ntool_radius_mm = {:g}\n", draft.rigid.empty() ? "\n" : "",
                        draft.tool_radius);
    if (!draft.quality.empty()) text += "\n" + draft.quality;
    return text;
}

}  // namespace palpate::draft
