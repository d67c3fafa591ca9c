// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/inspection/file_kind.hpp"

#include <algorithm>
#include <array>
#include <fstream>
#include <string>
#include <string_view>

#include "formats/asset/parts.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/meshing/files/imported_placement.hpp"

namespace palpate::inspection {
namespace {

// The first lines of a text file, as far as they tell what it holds.
std::string head_of(const std::filesystem::path& path) {
    std::string head(1024, '\0');
    std::ifstream stream(path, std::ios::binary);
    stream.read(head.data(), static_cast<std::streamsize>(head.size()));
    head.resize(static_cast<std::size_t>(stream.gcount()));
    return head;
}

bool has_ending(const std::string& ending, std::initializer_list<std::string_view> endings) {
    return std::ranges::find(endings, ending) != endings.end();
}

}  // namespace

FileKind kind_of_file(const std::filesystem::path& path) {
    if (std::filesystem::is_directory(path)) return FileKind::image;
    if (const std::string kind = other_kind(path); !kind.empty())
        throw InvalidInput({path.string(), kind, "a file or a folder of DICOM slices", "check the path"});
    const std::string ending = meshing::extension_of(path), head = head_of(path);
    if (asset::is_hdf5(path) || has_ending(ending, {".vtkhdf", ".h5"})) return FileKind::hdf5;
    if (ending == ".vtk" && head.find("POLYDATA") != std::string::npos) return FileKind::surface;
    if (ending == ".vtk" && head.find("UNSTRUCTURED_GRID") != std::string::npos) return FileKind::tetrahedra;
    if (has_ending(ending, {".vtu", ".msh", ".mesh"})) return FileKind::tetrahedra;
    if (has_ending(ending, {".vtp", ".stl", ".obj", ".ply"})) return FileKind::surface;
    if (has_ending(ending, {".nrrd", ".nhdr", ".mha", ".mhd", ".vti", ".vtk", ".hdr", ".img"}) ||
        imaging::is_nifti(path) || imaging::is_dicom(path) || head.starts_with("NRRD"))
        return FileKind::image;
    throw InvalidInput(
        {path.string(), "is nothing that can be inspected",
         "an image (NRRD, MetaImage, NIfTI, VTK image data, DICOM), tetrahedra (.vtu, .vtk, .msh, .mesh), a "
         "surface (.vtp, .vtk, .stl, .obj, .ply), a part (.obb.h5, .body.h5) or an asset (.vtkhdf)",
         "check that the file is whole and its ending names its format"});
}

}  // namespace palpate::inspection
