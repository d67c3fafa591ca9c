// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

namespace palpate::draft {

/// How an organ is found in a scan: structures as `palpate segment` takes them, one of which a person clicks
/// into.
struct ScanRecipes {
    std::string organ;                    ///< the structure that gives way
    std::string clicked;                  ///< the structure that seeds are placed in
    std::string where;                    ///< what to click, "the liver"
    std::vector<std::string> structures;  ///< "NAME: recipe=...", in order; `clicked` lacks its seeds
    std::string tissue;                   ///< a preset; empty: that of the organ's name
    std::vector<std::string> rigid;       ///< structures that do not give way
    double tool_radius = 0;               ///< mm; 0: by the mesh
    std::vector<std::string> held_by;     ///< labels that the organ is grown to; empty: its name tells
};

/// The recipes for an organ of that name. In a CT a liver and a nasopharynx have recipes of their own;
/// anything else is found as a solid organ, or, `against_background`, grows from its seeds against those of
/// the background. `seed` (p_P, mm): where the first one is, which a nasopharynx is cut out around. Throws
/// UsageError for a nasopharynx in anything but a CT.
ScanRecipes scan_recipes(const std::string& organ, bool ct, bool against_background,
                         const Eigen::Vector3d& seed);

}  // namespace palpate::draft
