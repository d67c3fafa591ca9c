// SPDX-License-Identifier: Apache-2.0
// Assets and their parts, digests checked and skipped.
#include "formats/asset/asset.hpp"
#include "formats/asset/parts.hpp"
#include "tests/fuzz/feed.hpp"
#include "tests/fuzz/hdf5_mutator.hpp"
#include "tests/fuzz/look_at.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 48, .base = std::size_t{1} << 16};
    fuzz::feed({data, size}, "fuzzed.vtkhdf", cap, [](const std::filesystem::path& path) {
        const std::string kind = asset::kind_of(path);
        if (kind == "body")
            fuzz::look_at(asset::read_body_part(path));
        else if (kind == "obb_tree")
            asset::read_obb_part(path);
        else
            fuzz::look_at(asset::read_asset(path));
    });
    return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
    return palpate::fuzz::mutated_hdf5({data, most}, size, seed);
}
