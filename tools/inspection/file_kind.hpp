// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace palpate::inspection {

enum class FileKind { hdf5, tetrahedra, surface, image };

/// Tells what reads a file: by its first bytes (HDF5, NRRD, DICOM), by its ending, of legacy VTK by what it
/// says it holds; a folder counts as DICOM slices. Throws InvalidInput naming what can be read if nothing
/// does.
FileKind kind_of_file(const std::filesystem::path& path);

}  // namespace palpate::inspection
