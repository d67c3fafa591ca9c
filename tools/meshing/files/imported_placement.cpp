// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/imported_placement.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <cctype>
#include <fmt/format.h>

#include "formats/model/errors.hpp"
#include "tools/meshing/files/text.hpp"

namespace palpate::meshing {
namespace {

double mm_per_unit(const std::string& unit) {
    static const std::map<std::string, double> units{
        {"um", 0.001}, {"mm", 1}, {"cm", 10}, {"m", 1000}, {"in", 25.4}};
    const auto found = units.find(lower_case(unit));
    if (found == units.end())
        throw UsageError({"unit '" + unit + "'", "is not known", "um, mm, cm, m or in", ""});
    return found->second;
}

}  // namespace

void place(std::vector<Eigen::Vector3d>& positions, const ImportedMeshOptions& options,
           const std::string& stated, const std::string& culprit, const NoteSink& note) {
    const std::string asked = lower_case(options.frame), written = lower_case(stated);
    for (const std::string& frame : {asked, written})
        if (!frame.empty() && frame != "lps" && frame != "ras")
            throw UsageError({"frame '" + frame + "'", "is not known", "lps or ras", ""});
    if (!asked.empty() && !written.empty() && asked != written)
        throw InvalidInput({culprit, "the file states " + stated, "the frame asked for, " + options.frame,
                            "leave the frame to the file"});
    const double scale = mm_per_unit(options.unit);
    const bool ras = (asked.empty() ? written : asked) == "ras";
    Eigen::AlignedBox3d box;
    for (Eigen::Vector3d& p : positions) {
        p *= scale;
        if (ras) p = {-p.x(), -p.y(), p.z()};
        box.extend(p);
    }
    if (!note || box.isEmpty()) return;
    const Eigen::Vector3d size = box.sizes();
    note(fmt::format("{}: {:.4g} x {:.4g} x {:.4g} mm, read as {} in {}", culprit, size.x(), size.y(),
                     size.z(), lower_case(options.unit), ras ? "RAS" : "LPS"));
}

std::string listed(const std::map<std::string, std::int64_t>& counts) {
    std::string text;
    for (const auto& [kind, count] : counts)
        text += fmt::format("{}{} of kind '{}'", text.empty() ? "" : ", ", count, kind);
    return text;
}

std::string extension_of(const std::filesystem::path& path) {
    return lower_case(path.extension().string());
}

}  // namespace palpate::meshing
