// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "tools/meshing/files/imported_mesh.hpp"

namespace palpate::meshing {

/// Turns positions of a file into mm in LPS, as the options say; `stated` is the frame that the file states
/// ("" if none). Notes the size of what it placed. Throws UsageError for unknown units and frames and
/// InvalidInput if file and options name different frames.
void place(std::vector<Eigen::Vector3d>& positions, const ImportedMeshOptions& options,
           const std::string& stated, const std::string& culprit, const NoteSink& note);

/// "12 triangles, 3 lines": what was found, for people.
std::string listed(const std::map<std::string, std::int64_t>& counts);

/// A file name's extension in lower case.
std::string extension_of(const std::filesystem::path& path);

}  // namespace palpate::meshing
