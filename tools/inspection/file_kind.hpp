// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace palpate::inspection {

enum class FileKind { hdf5, tetrahedra, surface, image };

/// Tells what reads a file: HDF5, NRRD, legacy VTK and DICOM by their first bytes, other files by their
/// ending, a folder as DICOM slices. Throws InvalidInput naming what can be read if nothing does.
FileKind kind_of_file(const std::filesystem::path& path);

}  // namespace palpate::inspection
