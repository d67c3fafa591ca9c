// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <string>
#include <vector>

#include "runtime/doctor/elf_file.hpp"
#include "runtime/doctor/machine.hpp"

namespace palpate::doctor {

/// Where a library is, as the machine's loader sees it.
struct LibraryPlace {
    enum class Standing {
        loads,          ///< the loader finds it
        not_cached,     ///< in a folder of /etc/ld.so.conf, but /etc/ld.so.cache does not know it
        off_path,       ///< in a folder where the loader does not look, perhaps under a longer name
        other_machine,  ///< of another architecture
        damaged         ///< not a whole shared library
    };
    std::filesystem::path file;  ///< on the machine, without its root
    Standing standing = Standing::loads;
    ElfFile elf;         ///< of a file that loads
    std::string reason;  ///< of a file that does not: its architecture, or what is damaged
};

/// Looks for a library by name as ld.so(8) does: LD_LIBRARY_PATH, `run_folders` (where "$ORIGIN" was
/// replaced), the folders of /etc/ld.so.conf as far as the cache knows them, then /lib and /usr/lib. If the
/// loader finds none, the next best place there is. Loads nothing.
std::optional<LibraryPlace> find_library(const Machine& machine, const std::string& name,
                                         const std::vector<std::string>& run_folders = {});

/// The library at a place on the machine; nothing if no file is there.
std::optional<LibraryPlace> library_at(const Machine& machine, const std::filesystem::path& file);

/// The folders in which a library wants its own needs looked for, "$ORIGIN" replaced by its own folder.
std::vector<std::string> run_folders_of(const LibraryPlace& library);

}  // namespace palpate::doctor
