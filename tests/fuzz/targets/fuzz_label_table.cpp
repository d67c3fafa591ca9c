// SPDX-License-Identifier: GPL-3.0-or-later
// Tables of label names.
#include "tests/fuzz/feed.hpp"
#include "tools/imaging/files/label_names.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 512, .base = std::size_t{1} << 20};
    fuzz::feed({data, size}, "fuzzed.txt", cap,
               [](const std::filesystem::path& path) { imaging::read_label_table(path); });
    return 0;
}
