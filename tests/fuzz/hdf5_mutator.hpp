// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <span>

namespace palpate::fuzz {

/// Changes the first `size` bytes of `buffer`, an HDF5 file of the kind that formats/asset/SPEC.md describes,
/// and returns their new number: sometimes bytes anywhere, sometimes in headers, sometimes the values or the
/// length of one dataset or attribute. Then checksums, digests, the ties between parts and the manifest are
/// made to fit, so that what lies behind them is tried too; one time in eight they are not. A file that
/// cannot be parsed gets whatever of these still applies. For a target's LLVMFuzzerCustomMutator.
std::size_t mutated_hdf5(std::span<std::uint8_t> buffer, std::size_t size, unsigned seed);

}  // namespace palpate::fuzz
