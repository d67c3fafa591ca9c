// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <functional>
#include <optional>

#include "formats/model/body.hpp"
#include "formats/model/progress.hpp"
#include "tools/fem/condensation/condensation_plan.hpp"
#include "tools/fem/gravity/posture.hpp"
#include "tools/stages/requests/condense_request.hpp"

namespace palpate::stages {

/// A condensed body and how that was done.
struct MadeBody {
    DeformableBody body;
    fem::CondensationPlan plan;
    std::optional<fem::Sag> sag;  ///< into another posture
};

/// Reads a mesh, holds its nodes and condenses it; writes nothing. `announce` is given the plan before the
/// long work begins. Throws UsageError for a word of the request that is not understood, InvalidInput for a
/// region that the mesh does not have (with the nearest names), and as fixed_nodes_of(), contact_nodes_of()
/// and condensed_body() do.
MadeBody make_body(const CondenseRequest& request, int threads, const ProgressCallback& progress,
                   const std::function<void(const fem::CondensationPlan&)>& announce);

}  // namespace palpate::stages
