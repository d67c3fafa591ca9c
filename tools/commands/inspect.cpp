// SPDX-License-Identifier: GPL-3.0-or-later
#include <nlohmann/json.hpp>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/inspection/file_kind.hpp"
#include "tools/inspection/image_summary.hpp"
#include "tools/inspection/part_summary.hpp"
#include "tools/inspection/shape_summary.hpp"

namespace {
using namespace palpate;
using inspection::FileKind;

inspection::Summary summary_of(const std::filesystem::path& file, const std::string& as) {
    const FileKind kind = inspection::kind_of_file(file);
    if (kind != FileKind::image && !as.empty())
        throw UsageError({"--as", "is for images", "", "leave it out"});
    switch (kind) {
        case FileKind::hdf5:
            return inspection::summary_of_hdf5(file);
        case FileKind::tetrahedra:
            return inspection::summary_of_tetrahedra(file);
        case FileKind::surface:
            return inspection::summary_of_surface(file);
        case FileKind::image:
            break;
    }
    using enum imaging::ImageKind;
    return inspection::summary_of_image(file, as.empty() ? found_out : as == "labels" ? labels : volume);
}

}  // namespace

int main(int argc, char** argv) {
    cli::Command command(
        {.name = "inspect",
         .summary = "Summarises what is in an asset, a part of one, a mesh, a label map or a volume.",
         .examples = {"palpate inspect liver.vtkhdf", "palpate inspect labels.seg.nrrd --json -"},
         .notes =
             "Reads images (NRRD, MetaImage, NIfTI, VTK image data, DICOM, DICOM SEG), tetrahedra (.vtu, "
             ".vtk, "
             ".msh, .mesh),\nsurfaces (.vtp, .vtk, .stl, .obj, .ply), parts (.obb.h5, .body.h5) and assets "
             "(.vtkhdf), changes none and mends nothing.\nOf assets and parts all digests are checked; "
             "'palpate verify' checks the mechanics too. An OBB tree belongs to the\nmesh, surface or body "
             "with its surface digest. The schema of --json is palpate.inspect/1 for an asset, else\n"
             "palpate.inspect.KIND/1: volume, labels, mesh, surface, obb_tree or body."});
    std::filesystem::path file;
    std::string as;
    command.input("file", file, "file, or folder of DICOM slices").required();
    command.option("--as", as, "what an image counts as; found out without it").one_of({"volume", "labels"});
    return command.run(argc, argv, [&](cli::Session& session) {
        imaging::set_imaging_threads(session.threads);
        inspection::Summary summary = summary_of(file, as);
        session.form = summary.form;
        session.text = summary.text;
        return std::move(summary.json);
    });
}
