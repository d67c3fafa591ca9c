// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>
#include <vector>

#include "formats/model/body.hpp"
#include "formats/model/progress.hpp"
#include "tools/stages/requests/pack_request.hpp"

namespace palpate::stages {

/// A case and what whoever made it must look at: bodies that hang, see fem::hangs(), and bone within elastic
/// ones, see bone_inside(); a sentence each, without its full stop.
struct MadeCase {
    Case made;
    std::vector<std::string> warnings;
};

/// Joins the parts that a request names to a case, builds the OBB trees that it does not name, computes what
/// can be felt of elastic bodies with the case's tool, cuts the scan to the bodies (none where it shows
/// nothing of them), and states in the provenance the software's versions, what made the parts and what their
/// meshes are like; writes nothing. Throws InvalidInput if a tree was built over another surface, if a colour
/// is of a body or region that there is not, if the provenance is no JSON or holds a path, and as what it
/// reads with. Cost: build_obb_tree() of every body, feel_of() of elastic ones, reading the scan.
MadeCase make_case(const PackRequest& request, int threads, const ProgressCallback& progress);

}  // namespace palpate::stages
