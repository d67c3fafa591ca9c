// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>

#include "tools/inspection/summary.hpp"

namespace palpate::inspection {

/// Reads what palpate itself writes as HDF5 - an asset, a condensed body, an OBB tree - with all its digests,
/// and sums it up. Throws InvalidInput if it is neither, or as read_asset() does.
Summary summary_of_hdf5(const std::filesystem::path& path);

}  // namespace palpate::inspection
