// SPDX-License-Identifier: Apache-2.0
// Surfaces of tools (STL, binary and ASCII).
#include "formats/stl_file/read_stl.hpp"
#include "tests/fuzz/feed.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 8, .base = std::size_t{1} << 16};
    fuzz::feed({data, size}, "fuzzed.stl", cap,
               [](const std::filesystem::path& path) { stl_file::read_stl(path); });
    return 0;
}
