// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::fem {

/// How a compliance may be stored.
enum class Representation { automatic, dense, hierarchical };

/// How a compliance is computed; each is a function of condense.hpp.
enum class CondensationMethod { trailing_block, solves, hierarchical };

/// What a user asks of a condensation.
struct CondensationOptions {
    Representation representation = Representation::automatic;
    double accuracy = 1e-3;      ///< of a hierarchical compliance: relative error of displacements
    double memory_bytes = 0;     ///< that may be in use at once; 0: what the machine has available
    double size_bytes = 0x1p30;  ///< that the stored compliance may take
    int threads = 1;
};

/// What a method will take.
struct CondensationForecast {
    CondensationMethod method;
    double seconds = 0, memory_bytes = 0, size_bytes = 0;
};

/// What will be done, and what it would have taken otherwise.
struct CondensationPlan {
    CondensationForecast chosen;
    std::string reason;
    std::vector<CondensationForecast> considered;
    double accuracy = 0;
    int threads = 1;
};

/// Forecasts each method from the symbolic factor of the body's stiffness in its order and the measured speed
/// of the dense kernels, and chooses: the faster exact one within memory and size, otherwise the hierarchical
/// one. A forecast's seconds are within a factor of two from about 1 000 contact nodes on, on an otherwise
/// idle machine. Throws InvalidInput naming what is needed if nothing fits. Needs a prepared_body(). Cost:
/// two orderings and two assemblies.
CondensationPlan plan_condensation(const DeformableBody& body, const CondensationOptions& options);

/// Memory that the machine can still give, in bytes.
double available_memory();

/// "trailing block", "panels of solves", "hierarchical".
std::string name_of(CondensationMethod method);

}  // namespace palpate::fem
