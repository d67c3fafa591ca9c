// SPDX-License-Identifier: Apache-2.0
// The one file of every set of precompiled headers (PalpateTargets.cmake).
