// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "tools/report/pictures/scene.hpp"
#include "tools/report/quality.hpp"
#include "tools/report/report.hpp"
#include "tools/report/verdict.hpp"

namespace palpate::report {

/// A deformable body with what the report derives from it once.
struct MeasuredBody {
    const DeformableBody& body;
    MeshSummary mesh;
    std::vector<Check> checks;
};

/// What a section may draw on.
struct ReportPage {
    const ReportInputs& inputs;
    std::vector<MeasuredBody> bodies;
    const PictureWindow* window = nullptr;  ///< null where no body is drawn
};

using SectionFunction = std::string(const ReportPage&);
SectionFunction slices_section, bodies_section, mesh_section, contract_section, worst_section,
    distances_section, mechanics_section, felt_section, certificate_section, touch_section, stages_section,
    provenance_section;

/// A part of the page: what the navigation shows, and what makes its HTML; "" leaves it out.
struct Section {
    const char* anchor;
    const char* title;
    SectionFunction* make;
};

/// The sections in the order of the page.
inline constexpr Section report_sections[] = {
    {"slices", "Slices", slices_section},
    {"bodies", "Bodies", bodies_section},
    {"mesh", "Meshes", mesh_section},
    {"contract", "Contract", contract_section},
    {"worst", "Worst elements", worst_section},
    {"distances", "Distances", distances_section},
    {"mechanics", "Materials", mechanics_section},
    {"felt", "Felt", felt_section},
    {"certificate", "Certificate", certificate_section},
    {"touch", "Touch", touch_section},
    {"stages", "Stages", stages_section},
    {"provenance", "Provenance", provenance_section},
};

/// The two directions that bodies are looked at from, with words.
struct NamedDirection {
    ViewDirection direction;
    std::string words;
};
const std::vector<NamedDirection>& view_directions();

std::vector<ViewDirection> directions();

/// Pictures of `what`, one from each of view_directions(), with names at their marks.
std::string figures_of(const std::vector<SceneView>& views, const std::string& what,
                       const std::vector<std::string>& mark_names);

/// A coloured square beside a name.
std::string swatch(const Label& label);

}  // namespace palpate::report
