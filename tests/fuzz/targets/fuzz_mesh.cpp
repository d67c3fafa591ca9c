// SPDX-License-Identifier: GPL-3.0-or-later
// Surfaces and tetrahedra, our own and others'. Every reader of a format gets every input and leaves what is
// not its own at once.
#include "tests/fuzz/feed.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/mesh_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 16384, .base = std::size_t{8} << 20};
    const auto feed = [&](const char* name, const std::function<void(const std::filesystem::path&)>& read) {
        fuzz::feed({data, size}, name, cap, read);
    };
    feed("fuzzed.vtp", meshing::read_surface);
    feed("fuzzed.vtu", meshing::read_tetrahedra);
    for (const char* name : {"fuzzed.vtp", "fuzzed.vtk", "fuzzed.stl", "fuzzed.obj", "fuzzed.ply"})
        feed(name, [](const auto& path) { meshing::read_imported_surface(path, {}); });
    for (const char* name : {"fuzzed.vtu", "fuzzed.vtk", "fuzzed.msh", "fuzzed.mesh"})
        feed(name, [](const auto& path) { meshing::read_imported_tetrahedra(path, {}); });
    return 0;
}
