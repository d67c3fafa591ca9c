// SPDX-License-Identifier: GPL-3.0-or-later
// Case files (TOML).
#include "tests/fuzz/feed.hpp"
#include "tools/case_builder/case_file.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 512, .base = std::size_t{4} << 20};
    fuzz::feed({data, size}, "fuzzed.toml", cap,
               [](const std::filesystem::path& path) { case_builder::read_case_file(path); });
    return 0;
}
