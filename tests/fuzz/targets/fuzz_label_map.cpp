// SPDX-License-Identifier: GPL-3.0-or-later
// Label maps and volumes. Every reader of a format gets every input and leaves what is not its own at once.
#include "tests/fuzz/feed.hpp"
#include "tools/imaging/files/image_files.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 16384, .base = std::size_t{8} << 20};
    for (const char* name : {"fuzzed.nrrd", "fuzzed.mha", "fuzzed.nii", "fuzzed.vti", "fuzzed.vtk"})
        fuzz::feed({data, size}, name, cap, [](const std::filesystem::path& path) {
            imaging::ReadOptions options;
            options.overlaps = imaging::Overlaps::smaller_wins;
            imaging::read_image(path, imaging::ImageKind::found_out, {}, options);
        });
    return 0;
}
