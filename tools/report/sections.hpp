// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "tools/report/pictures/scene.hpp"
#include "tools/report/quality.hpp"
#include "tools/report/report.hpp"
#include "tools/report/verdict.hpp"

namespace palpate {

/// A deformable body with what the report derives from it once.
struct MeasuredBody {
    const DeformableBody& body;
    MeshSummary mesh;
    std::vector<Check> checks;
};

/// The parts of the page, each one HTML section.
std::string slices_section(const ReportInputs& inputs);
std::string bodies_section(const Case& patient_case);
std::string mesh_section(const Case& patient_case, const std::vector<MeasuredBody>& bodies);
std::string contract_section(const std::string& provenance);
std::string worst_section(const std::vector<MeasuredBody>& bodies);
std::string distances_section(const ReportInputs& inputs);
std::string mechanics_section(const Case& patient_case);
std::string certificate_section(const std::vector<MeasuredBody>& bodies);
std::string touch_section(const ReportInputs& inputs);
std::string stages_section(const std::vector<StageRecord>& stages);
std::string provenance_section(const std::string& provenance);

/// The two directions that bodies are looked at from, with words.
struct NamedDirection {
    ViewDirection direction;
    std::string words;
};
const std::vector<NamedDirection>& view_directions();

/// A coloured square beside a name.
std::string swatch(const Label& label);

}  // namespace palpate
