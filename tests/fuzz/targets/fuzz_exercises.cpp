// SPDX-License-Identifier: Apache-2.0
// The trainer's exercises (TOML).
#include "runtime/training/exercise_file.hpp"
#include "tests/fuzz/feed.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 512, .base = std::size_t{1} << 16};
    fuzz::feed({data, size}, "fuzzed.toml", cap,
               [](const std::filesystem::path& path) { training::read_exercises(path); });
    return 0;
}
