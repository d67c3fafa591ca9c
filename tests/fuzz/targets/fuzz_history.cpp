// SPDX-License-Identifier: Apache-2.0
// A trainee's earlier attempts (JSON).
#include "runtime/training/attempt_record.hpp"
#include "tests/fuzz/feed.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 512, .base = std::size_t{1} << 16};
    fuzz::feed({data, size}, "fuzzed.json", cap, [](const std::filesystem::path& path) {
        training::read_history(path.parent_path(), "liver", "touch", [](const std::string&) {});
    });
    return 0;
}
