// SPDX-License-Identifier: GPL-3.0-or-later
// DICOM: the files of a small series, one after the other, as a folder that is imported and each by itself,
// as an image or a segmentation object, and as the series that an export refers to.
#include "tests/fuzz/feed.hpp"
#include "tools/archive/objects/reference.hpp"
#include "tools/archive/privacy/find_identity.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace {

using Bytes = std::span<const std::uint8_t>;

// A file begins with each preamble, of 128 bytes and "DICM".
std::vector<Bytes> files_of(Bytes input) {
    constexpr std::size_t preamble = 128;
    const std::string_view text(reinterpret_cast<const char*>(input.data()), input.size());
    std::vector<Bytes> files;
    std::size_t begin = 0;
    for (auto at = text.find("DICM"); at != std::string_view::npos; at = text.find("DICM", at + 1))
        if (at > begin + preamble) {
            files.push_back(input.subspan(begin, at - preamble - begin));
            begin = at - preamble;
        }
    files.push_back(input.subspan(begin));
    return files;
}

}  // namespace

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 16384, .base = std::size_t{8} << 20};
    imaging::ReadOptions options;
    options.accept_gaps = true;
    options.overlaps = imaging::Overlaps::smaller_wins;
    const auto files = files_of({data, size});
    fuzz::feed_folder(files, "series", cap, [&](const std::filesystem::path& folder) {
        imaging::read_volume(folder, {}, options);
    });
    fuzz::feed_folder(files, "series", cap, [&](const std::filesystem::path& folder) {
        archive::read_reference(folder, options, {});
    });
    for (const Bytes file : files) {
        fuzz::feed(file, "fuzzed.dcm", cap, [&](const std::filesystem::path& path) {
            imaging::read_image(path, imaging::ImageKind::found_out, {}, options);
        });
        fuzz::feed(file, "fuzzed.dcm", cap, [](const std::filesystem::path& path) {
            if (imaging::is_dicom(path)) archive::find_identity({path}, archive::Machine{});
        });
    }
    return 0;
}
