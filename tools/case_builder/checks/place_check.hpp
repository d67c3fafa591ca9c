// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <span>

#include "formats/model/image_grid.hpp"
#include "tools/case_builder/case_file.hpp"
#include "tools/case_builder/stage_runner.hpp"

namespace palpate::case_builder {

/// Looks in a case for places that miss what the stages before have found, so that it is told before the next
/// one works: once an image is imported, seeds and cut boxes beside it; once it is segmented, rules for
/// nodes (a box, a sphere, a plane) beside the labels of their body. `done`: the stage that has just been
/// done, of this case. Throws InvalidInput that names every such place with line and key.
void check_places(const std::filesystem::path& path, const CaseFile& case_file,
                  std::span<const Override> overrides, const StageRecord& done);

}  // namespace palpate::case_builder
