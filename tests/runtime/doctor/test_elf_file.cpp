// SPDX-License-Identifier: Apache-2.0
#include <algorithm>
#include <cstring>
#include <elf.h>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <random>

#include "runtime/doctor/elf_file.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace doctor;
using sample::refusal;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

const std::filesystem::path hd = std::filesystem::path(DOCTOR_STUBS) / "libHD.so.3.4";

struct ElfFileOf : testing::Test {
    sample::Scratch folder;
    std::filesystem::path file = folder / "library.so";
    std::vector<char> bytes = sample::read_bytes(hd);

    std::string refused(const std::vector<char>& content) {
        sample::write_bytes(file, content);
        return refusal([&] { read_elf_file(file); });
    }
};

TEST_F(ElfFileOf, a_library_names_what_it_needs_and_where_it_wants_it_looked_for) {
    const ElfFile elf = read_elf_file(hd);
    EXPECT_TRUE(elf.for_this_machine);
    EXPECT_THAT(elf.needed, ElementsAre("libncurses.so.5", "libPhantomIOLib.so.42"));
    EXPECT_THAT(elf.run_folders, ElementsAre("$ORIGIN/driver"));
}

TEST_F(ElfFileOf, another_architecture_is_named_and_not_read_further) {
    bytes[EI_CLASS] = ELFCLASS32;
    bytes[offsetof(Elf64_Ehdr, e_machine)] = EM_386;
    bytes.resize(EI_NIDENT + 4);
    sample::write_bytes(file, bytes);
    const ElfFile elf = read_elf_file(file);
    EXPECT_FALSE(elf.for_this_machine);
    EXPECT_EQ(elf.machine, "i386, 32 bit");
    EXPECT_TRUE(elf.needed.empty());
}

TEST_F(ElfFileOf, what_is_no_shared_library_is_refused) {
    EXPECT_THAT(refused({}), HasSubstr("ends before what it announces"));
    EXPECT_THAT(refused(std::vector<char>(1000, 'x')), HasSubstr("is not an ELF file"));
    bytes[offsetof(Elf64_Ehdr, e_type)] = ET_REL;
    EXPECT_THAT(refused(bytes), HasSubstr("is not a shared library"));
    EXPECT_THAT(refusal([&] { read_elf_file(folder / ""); }), HasSubstr("is not a file"));
    EXPECT_THAT(refusal([&] { read_elf_file("/dev/zero"); }), HasSubstr("is not a file"));
}

TEST_F(ElfFileOf, a_file_cut_before_its_texts_is_refused) {
    std::size_t first_text = bytes.size();
    const std::string name = "libPhantomIOLib.so.42";
    first_text = static_cast<std::size_t>(std::ranges::search(bytes, name).begin() - bytes.begin());
    for (std::size_t size = 0; size < first_text + name.size(); size += 7) {
        std::vector<char> cut(bytes.begin(), bytes.begin() + static_cast<std::ptrdiff_t>(size));
        EXPECT_FALSE(refused(cut).empty()) << size;
    }
}

TEST_F(ElfFileOf, a_table_larger_than_any_is_refused_before_it_is_read) {
    const Elf64_Half many = 0xfffe;
    std::memcpy(&bytes[offsetof(Elf64_Ehdr, e_phnum)], &many, sizeof(many));
    EXPECT_THAT(refused(bytes), HasSubstr("has a table of 65534 entries"));
}

TEST_F(ElfFileOf, changed_bytes_are_read_or_refused_but_do_no_harm) {
    std::mt19937 random(1);
    std::size_t refusals = 0;
    for (int round = 0; round < 3000; ++round) {
        std::vector<char> changed = bytes;
        for (int change = 0; change < 4; ++change)
            changed[random() % std::min<std::size_t>(changed.size(), 1024)] = static_cast<char>(random());
        refusals += refused(changed).empty() ? 0 : 1;
    }
    EXPECT_GT(refusals, 0U);
}

}  // namespace
}  // namespace palpate
