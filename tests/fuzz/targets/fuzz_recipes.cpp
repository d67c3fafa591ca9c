// SPDX-License-Identifier: GPL-3.0-or-later
// Recipe files (JSON).
#include "tests/fuzz/feed.hpp"
#include "tools/imaging/recipes/recipe_json.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 512, .base = std::size_t{1} << 20};
    fuzz::feed({data, size}, "fuzzed.json", cap, [](const std::filesystem::path& path) {
        for (const imaging::StructureRecipe& structure : imaging::read_recipe_file(path))
            imaging::check_recipe(structure);
    });
    return 0;
}
