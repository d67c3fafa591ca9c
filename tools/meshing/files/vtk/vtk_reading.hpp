// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <concepts>
#include <filesystem>
#include <optional>
#include <string>
#include <vector>
#include <vtkAlgorithm.h>
#include <vtkCallbackCommand.h>
#include <vtkDataObject.h>
#include <vtkDataReader.h>
#include <vtkDataSetAttributes.h>
#include <vtkNew.h>
#include <vtkPoints.h>

#include "formats/model/label_map.hpp"
#include "tools/meshing/files/vtk/vtk_file_checks.hpp"

namespace palpate::meshing {

/// VTK prints errors unless somebody listens; this listens and remembers that there was one.
class VtkErrorListener {
  public:
    VtkErrorListener();
    vtkCommand* command() { return command_; }
    bool failed() const { return failed_; }

  private:
    vtkNew<vtkCallbackCommand> command_;
    bool failed_ = false;
};

/// Runs a reader whose file name is set. Throws InvalidInput naming the file and `kind` if the file is absent
/// or VTK complains about anything in it or wants more memory than there is; what `listener` heard counts.
void run_reader(vtkAlgorithm& reader, VtkErrorListener& listener, const std::filesystem::path& path,
                const char* kind);

/// Checks the counts that a file announces, names it to a reader and runs that.
template <typename Reader>
void read_with(Reader& reader, const std::filesystem::path& path, const char* kind) {
    VtkErrorListener listener;
    if constexpr (requires { reader.SetParserErrorObserver(listener.command()); }) {
        reader.set_room(require_plausible_xml(path));
        reader.SetReaderErrorObserver(listener.command());
        reader.SetParserErrorObserver(listener.command());
    }
    if constexpr (std::derived_from<Reader, vtkDataReader>) require_sound_legacy(path);
    reader.SetFileName(path.c_str());
    run_reader(reader, listener, path, kind);
}

/// Copies points; throws InvalidInput naming the first that is not finite.
std::vector<Eigen::Vector3d> read_points(vtkPoints* points, const std::filesystem::path& path);

/// Copies an integer array with one value per point or cell, nothing if there is none of that name; throws
/// InvalidInput if its size is another or a value no whole number of 32 bits.
std::optional<std::vector<std::int32_t>> read_integers(vtkDataSetAttributes* attributes, const char* name,
                                                       std::size_t count, const std::filesystem::path& path);

/// Reads the names, values and colours that write_tetrahedra() leaves in FieldData; empty if there are none.
std::vector<Label> read_labels(vtkDataObject* data, const std::string& prefix);

/// The frame that FieldData SPACE states ("LPS", "RAS"); empty if it states none.
std::string space_of(vtkDataObject* data);

/// Labels that occur in `values` (those above 0), with the names that `known` gives them or "region <value>".
std::vector<Label> occurring_labels(const std::vector<std::int32_t>& values, const std::vector<Label>& known);

}  // namespace palpate::meshing
