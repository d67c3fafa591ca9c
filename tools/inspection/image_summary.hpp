// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "tools/imaging/files/image_files.hpp"
#include "tools/inspection/summary.hpp"

namespace palpate::inspection {

/// Reads an image and sums up its grid, and its values or its labels; `notes` are what read_image() said
/// meanwhile. Throws as that does.
Summary summary_of_image(const std::filesystem::path& path, imaging::ImageKind kind);

}  // namespace palpate::inspection
