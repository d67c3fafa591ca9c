// SPDX-License-Identifier: GPL-3.0-or-later
// Lists of nodes (text).
#include "tests/formats/sample_case.hpp"
#include "tests/fuzz/feed.hpp"
#include "tools/fem/assembly/node_rules.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 256, .base = std::size_t{1} << 16};
    static const TetMesh mesh = sample::cube_mesh(1, 20);
    static const BoundarySurface boundary = boundary_surface(mesh);
    fuzz::feed({data, size}, "fuzzed.txt", cap, [](const std::filesystem::path& path) {
        const std::vector<fem::NodeRule> rules{{"--fixed nodes:" + path.string(), fem::ListedNodes{path}}};
        fem::fixed_nodes_of(mesh, boundary, rules);
    });
    return 0;
}
