// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>
#include <vector>

namespace palpate::doctor {

/// What a shared library says of itself.
struct ElfFile {
    std::string machine;            ///< "x86-64", "i386", "aarch64", "machine 40", each with its word's bits
    bool for_this_machine = false;  ///< of this program's architecture; only then is the rest filled
    std::vector<std::string> needed;       ///< libraries it needs (DT_NEEDED)
    std::vector<std::string> run_folders;  ///< where it wants them looked for (DT_RUNPATH or DT_RPATH)
};

/// Reads a shared library's dynamic section without loading it. Trusts nothing: every offset is held against
/// the file's size. Throws InvalidInput if this is not a whole shared library. Source: elf(5).
ElfFile read_elf_file(const std::filesystem::path& path);

}  // namespace palpate::doctor
