// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <memory>
#include <span>

#include "tools/case_builder/case_file.hpp"
#include "tools/case_builder/overrides.hpp"
#include "tools/case_builder/stage_runner.hpp"

namespace palpate::case_builder {

/// Looks in a case for places that miss what a build's stages find, so that it is told before the next one
/// works: once an image is imported, seeds and boxes that structures are cut to; once it is segmented, rules
/// for nodes (a box, a sphere, a plane) beside the labels of their body. Seeds of files and scribbles are not
/// looked at: `palpate segment` does.
class PlaceCheck {
  public:
    /// Reads the case file, of which `case_file` was made with `overrides` and must outlive this, as it is
    /// now. Throws as read_toml().
    PlaceCheck(const std::filesystem::path& path, const CaseFile& case_file,
               std::span<const Override> overrides);
    ~PlaceCheck();

    /// To be called after each stage, in their order. Throws InvalidInput that names every place beside what
    /// that stage found, with line and key.
    void after(const StageRecord& done);

  private:
    struct Read;
    std::unique_ptr<Read> read_;
};

}  // namespace palpate::case_builder
