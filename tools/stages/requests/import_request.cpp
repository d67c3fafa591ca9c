// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/stages/requests/import_request.hpp"

namespace palpate::stages {

void declare(cli::Command& command, ImportRequest& request) {
    command
        .input("input", request.input,
               "DICOM folder or file, .nrrd, .nhdr, .mha, .mhd, .nii, .nii.gz, .vti or .vtk")
        .required();
    command.output("-o,--output", request.output, "volume (.nrrd) or, with --labels, label map (.seg.nrrd)");
    command.flag("--list", request.list, "list the DICOM series of the input and make nothing");
    command.option("--series", request.series, "DICOM series to read: its number, UID or description");
    command.flag("--accept-gaps", request.accept_gaps,
                 "interpolate missing, uneven, doubled or tilted DICOM slices linearly onto an even grid");
    command.option("--nifti-frame", request.nifti_frame,
                   "qform or sform, for a NIfTI file in which both are set and disagree");
    command
        .option("--scale", request.scale,
                "of a CT whose values are no HU, as in 8 bit: HU = SCALE x value + OFFSET")
        .positive();
    command.option("--offset", request.offset, "see --scale", "HU");
    command.flag("--deface", request.deface,
                 "take the face of a head's CT away: soft tissue in front of its bone becomes air");
    command.flag("--labels", request.labels, "the input is a label map");
    command.option("--label-names", request.label_names,
                   "names of the labels: value=name,..., a known table or a file");
    command.option("--overlaps", request.overlaps,
                   "where segments of a label map overlap: refuse, later (in the file) or smaller wins");
}

}  // namespace palpate::stages
