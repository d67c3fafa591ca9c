// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>

// How Eigen aligns its types, and which allocator it uses, depends on the vector instructions that a program
// is compiled for. Palpate's libraries are compiled for 16 bytes; a program with another layout would crash.
static_assert(
    EIGEN_MAX_ALIGN_BYTES == 16,
    "Palpate's headers need EIGEN_MAX_ALIGN_BYTES=16: link Palpate's CMake targets, which define it, "
    "or define it yourself before Eigen is included");
