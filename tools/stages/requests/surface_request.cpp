// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/requests/surface_request.hpp"

namespace palpate::stages {

void declare(cli::Command& command, SurfaceRequest& request) {
    const cli::Option volume =
        command.input("--volume", request.volume, "grey volume (NRRD, NIfTI, MetaImage, DICOM)");
    const cli::Option level = command.option(
        "--isovalue", request.isovalue, "surface around values from here up", "HU for CT", "isovalue_hu");
    level.needs(volume);
    volume.needs(level);
    const cli::Option labels =
        command.input("--labels", request.labels, "label map (.seg.nrrd, NIfTI, NRRD)");
    command.option("--label", request.label_names, "label by name or value; may be repeated");
    const cli::Option file = command.input("--surface-file", request.surface_file,
                                           "imported surface instead (.vtp, .vtk, .stl, .obj, .ply)");
    file.excludes(volume).excludes(labels);
    command.option("--unit", request.unit, "of that file: um, mm, cm, m or in", "", "surface_unit")
        .needs(file);
    command
        .option("--frame", request.frame, "of that file: lps or ras; by default what it states, else lps", "",
                "surface_frame")
        .needs(file);
    command.option("--mask-reach", request.mask_reach, "how far beyond its labels the volume counts",
                   "voxels");
    command.option("--smoothing", request.smoothing, "Gaussian on labels; below 0: the largest voxel edge",
                   "mm", "smoothing_mm");
    command.flag("--keep-largest", request.keep_largest, "keep the piece of largest area only");
    command.option("--min-triangles", request.min_triangles, "leave out pieces of fewer triangles");
    const cli::Option budget =
        command.option("--max-triangles", request.max_triangles, "decimate to this many; 0: do not");
    command
        .option("--max-distance", request.max_distance,
                "largest distance between full and decimated surface; 0: any, it is measured", "mm",
                "max_distance_mm")
        .needs(budget);
    command.output("-o,--output", request.output, "triangle surface (.vtp), LPS mm").required();
}

}  // namespace palpate::stages
