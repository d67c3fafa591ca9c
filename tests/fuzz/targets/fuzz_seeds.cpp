// SPDX-License-Identifier: GPL-3.0-or-later
// Seeds: 3D Slicer's markups, as JSON and as table.
#include "tests/fuzz/feed.hpp"
#include "tools/imaging/voxels/seeds.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 512, .base = std::size_t{1} << 20};
    for (const char* name : {"fuzzed.mrk.json", "fuzzed.fcsv"})
        fuzz::feed({data, size}, name, cap,
                   [](const std::filesystem::path& path) { imaging::read_seeds(path); });
    return 0;
}
