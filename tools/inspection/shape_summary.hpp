// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "tools/inspection/summary.hpp"

namespace palpate::inspection {

/// Reads tetrahedra or a triangle surface as they are and sums up their size and shape. Nothing is mended, so
/// that what importing would mend or refuse shows. Throws as read_unrepaired_tetrahedra() and
/// read_unrepaired_surface() do.
Summary summary_of_tetrahedra(const std::filesystem::path& path);
Summary summary_of_surface(const std::filesystem::path& path);

}  // namespace palpate::inspection
