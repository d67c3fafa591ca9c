// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

#include "tools/cli/command.hpp"

namespace palpate::stages {

/// What `palpate import` is asked for.
struct ImportRequest {
    std::filesystem::path input;   ///< file, or folder of DICOM slices
    std::filesystem::path output;  ///< volume (.nrrd) or label map (.seg.nrrd); empty to list series
    bool list = false;             ///< list the DICOM series and make nothing
    std::string series;            ///< number, UID or description; empty: the only or main one
    bool accept_gaps = false;
    std::string nifti_frame;          ///< "qform", "sform" or empty
    double scale = 1, offset = 0;     ///< HU = scale * value + offset, of an image
    bool deface = false;              ///< takes a head's face out of a CT
    bool labels = false;              ///< the input is a label map
    std::string label_names;          ///< as name_labels() takes it
    std::string overlaps = "refuse";  ///< or "later" or "smaller"
};

/// Binds the options of `palpate import`.
void declare(cli::Command& command, ImportRequest& request);

}  // namespace palpate::stages
