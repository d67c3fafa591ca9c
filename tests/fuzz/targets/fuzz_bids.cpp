// SPDX-License-Identifier: GPL-3.0-or-later
// BIDS datasets: dataset_description.json, and names of files, one a line.
#include <sstream>

#include "tests/fuzz/feed.hpp"
#include "tools/cohort/bids/bids_folder.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 512, .base = std::size_t{1} << 20};
    fuzz::feed({data, size}, "dataset_description.json", cap, [](const std::filesystem::path& path) {
        cohort::is_ours(cohort::dataset_description(path.parent_path()));
    });
    std::istringstream stream(std::string(reinterpret_cast<const char*>(data), size));
    for (std::string name; std::getline(stream, name);)
        if (const auto parsed = cohort::parse_bids_name(name)) {
            cohort::spelled(*parsed);
            cohort::in_own_space(*parsed, "T1w");
        }
    return 0;
}
