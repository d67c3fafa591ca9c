// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/vtk/vtk_reading.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <limits>
#include <new>
#include <set>
#include <vtkErrorCode.h>
#include <vtkExecutive.h>
#include <vtkFieldData.h>
#include <vtkStringArray.h>

#include "formats/model/errors.hpp"

namespace palpate::meshing {

namespace fs = std::filesystem;

namespace {

bool fits_label(double value) {
    return std::abs(value) <= std::numeric_limits<std::int32_t>::max() && value == std::floor(value);
}

}  // namespace

VtkErrorListener::VtkErrorListener() {
    command_->SetClientData(&failed_);
    command_->SetCallback(
        [](vtkObject*, unsigned long, void* failed, void*) { *static_cast<bool*>(failed) = true; });
}

void run_reader(vtkAlgorithm& reader, VtkErrorListener& listener, const fs::path& path, const char* kind) {
    if (!fs::exists(path)) throw InvalidInput({path.string(), "no such file", "", "check the path"});
    reader.AddObserver(vtkCommand::ErrorEvent, listener.command());
    reader.AddObserver(vtkCommand::WarningEvent, listener.command());
    reader.GetExecutive()->AddObserver(vtkCommand::ErrorEvent, listener.command());
    try {
        reader.Update();
    } catch (const std::bad_alloc&) {
        throw InvalidInput({path.string(), "announces more data than there is memory", "", "write it again"});
    }
    if (listener.failed() || reader.GetErrorCode() != vtkErrorCode::NoError)
        throw InvalidInput({path.string(), std::string("is not a readable ") + kind, "", "write it again"});
}

std::vector<Eigen::Vector3d> read_points(vtkPoints* points, const fs::path& path) {
    std::vector<Eigen::Vector3d> positions(points ? static_cast<std::size_t>(points->GetNumberOfPoints())
                                                  : 0);
    for (std::size_t i = 0; i < positions.size(); ++i) {
        points->GetPoint(static_cast<vtkIdType>(i), positions[i].data());
        if (!positions[i].allFinite())
            throw InvalidInput({path.string(), "point " + std::to_string(i) + " is not finite", "", ""});
    }
    return positions;
}

std::vector<Label> read_labels(vtkDataObject* data, const std::string& prefix) {
    vtkFieldData* fields = data->GetFieldData();
    auto* names = vtkStringArray::SafeDownCast(fields->GetAbstractArray((prefix + "_names").c_str()));
    vtkDataArray* values = fields->GetArray((prefix + "_values").c_str());
    vtkDataArray* colours = fields->GetArray((prefix + "_colours").c_str());
    std::vector<Label> labels;
    if (!names || !values || names->GetNumberOfValues() != values->GetNumberOfTuples()) return labels;
    for (vtkIdType i = 0; i < names->GetNumberOfValues(); ++i) {
        if (!fits_label(values->GetTuple1(i))) continue;
        const auto value = static_cast<std::int32_t>(values->GetTuple1(i));
        Label label{value, names->GetValue(i), default_label_colour(value)};
        if (colours && colours->GetNumberOfComponents() == 3 && i < colours->GetNumberOfTuples())
            for (int c = 0; c < 3; ++c) label.colour[c] = static_cast<float>(colours->GetComponent(i, c));
        labels.push_back(std::move(label));
    }
    return labels;
}

std::optional<std::vector<std::int32_t>> read_integers(vtkDataSetAttributes* attributes, const char* name,
                                                       std::size_t count, const fs::path& path) {
    vtkDataArray* array = attributes->GetArray(name);
    if (!array) return std::nullopt;
    if (array->GetNumberOfComponents() != 1 || static_cast<std::size_t>(array->GetNumberOfTuples()) != count)
        throw InvalidInput({path.string(), std::string("array '") + name + "' has the wrong size",
                            std::to_string(count) + " values", "write it again"});
    std::vector<std::int32_t> values(count);
    for (std::size_t i = 0; i < count; ++i) {
        const double value = array->GetTuple1(static_cast<vtkIdType>(i));
        if (!fits_label(value))
            throw InvalidInput({path.string(), fmt::format("array '{}' has the value {}", name, value),
                                "whole numbers of 32 bits", "renumber it where it was made"});
        values[i] = static_cast<std::int32_t>(value);
    }
    return values;
}

std::string space_of(vtkDataObject* data) {
    auto* space = vtkStringArray::SafeDownCast(data->GetFieldData()->GetAbstractArray("SPACE"));
    return space && space->GetNumberOfValues() == 1 ? std::string(space->GetValue(0)) : "";
}

// Labels that occur in `values` (those above 0), with the names that `known` gives them.
std::vector<Label> occurring_labels(const std::vector<std::int32_t>& values,
                                    const std::vector<Label>& known) {
    std::vector<Label> labels;
    for (const std::int32_t value : std::set(values.begin(), values.end())) {
        if (value <= 0) continue;
        const auto found = std::ranges::find(known, value, &Label::value);
        labels.push_back(found != known.end()
                             ? *found
                             : Label{value, "region " + std::to_string(value), default_label_colour(value)});
    }
    return labels;
}

}  // namespace palpate::meshing
