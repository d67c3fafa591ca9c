// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <string>

#include "formats/model/body.hpp"

namespace palpate::experiments {

/// A case of one rigid body, its OBB tree built.
Case rigid_case(const std::string& name, TriangleMesh surface, const HapticSettings& haptics);

/// A plate whose top is z = 0, 200 mm square and `thickness` (mm) thick, closed.
TriangleMesh plate_surface(double thickness = 100);

}  // namespace palpate::experiments
