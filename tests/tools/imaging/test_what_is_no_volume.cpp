// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <map>
#include <string>

#include "tests/tools/imaging/hand_written_images.hpp"
#include "tests/tools/imaging/refusals.hpp"

namespace palpate {
namespace {

using test::TemporaryFolder;
using test::write_bytes;

TEST(ReadVolume, what_is_no_volume_is_called_so_however_large_its_lines_are) {
    const TemporaryFolder folder;
    const std::string binary = std::string(3 << 20, '\x7f') + std::string(20000, '\n');
    for (const char* name : {"scan.img", "scan.hdr"}) {
        write_bytes(folder / name, binary);
        EXPECT_SAYS(test::volume_refusal(folder / name), "is one half of an Analyze or NIfTI pair");
    }
    for (const auto& [name, start] : std::map<std::string, std::string>{
             {"report.pdf", "%PDF-1.4\n"}, {"photo.jpg", "\xff\xd8\xff\xe0"}, {"scan.mha", "\xff\xd8"}}) {
        write_bytes(folder / name, start + binary);
        EXPECT_SAYS(test::volume_refusal(folder / name), "is not a volume") << name;
    }
    for (const auto& [name, start] : std::map<std::string, std::string>{
             {"v.nrrd", "NRRD0004\n#"}, {"v.mha", "NDims = 3\nComment = "}, {"w.mha", "NDims = 3 "}}) {
        write_bytes(folder / name, start + std::string(3 << 20, ' ') + "x");
        EXPECT_SAYS(test::volume_refusal(folder / name), "more than 8192 lines or 1 MiB") << name;
    }
}

}  // namespace
}  // namespace palpate
