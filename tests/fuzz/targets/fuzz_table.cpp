// SPDX-License-Identifier: GPL-3.0-or-later
// A cohort's table of patients.
#include "tests/fuzz/feed.hpp"
#include "tools/cohort/patient_table.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 512, .base = std::size_t{1} << 20};
    fuzz::feed({data, size}, "fuzzed.tsv", cap,
               [](const std::filesystem::path& path) { cohort::read_patient_table(path); });
    return 0;
}
