// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

namespace palpate::imaging {

/// Throws InvalidInput where NrrdIO would not come to an end with a header: of more than 8192 lines or 1 MiB,
/// each of which it holds against each other, or of a pattern of more than 65536 files; where one of its
/// files is no file but a pipe, a device or the standard input, or lies outside the header's folder; and for
/// sizes that are no whole numbers, of which NrrdIO would take the beginning.
void require_short_nrrd_header(const std::filesystem::path& path);

/// Throws InvalidInput where MetaIO would not come to an end with a header, which has as many lines and 1 to
/// 9 dimensions, or would write behind the 255 bytes that it has for the name of a field and some texts; for
/// a file of voxels outside the header's folder, for sizes that are no whole numbers, and for elements that
/// are none.
void require_short_metaimage_header(const std::filesystem::path& path);

}  // namespace palpate::imaging
