// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/loader.hpp"

#include <algorithm>
#include <fstream>
#include <sstream>

#include "formats/model/errors.hpp"

namespace palpate::doctor {
namespace {

#if defined(__aarch64__)
constexpr const char* architecture = "aarch64-linux-gnu";
#else
constexpr const char* architecture = "x86_64-linux-gnu";
#endif

using Folders = std::vector<std::filesystem::path>;

Folders split_folders(const std::string& list) {
    Folders result;
    std::istringstream stream(list);
    for (std::string folder; std::getline(stream, folder, ':');)
        if (!folder.empty()) result.emplace_back(folder);
    return result;
}

// Folders named by a file of ldconfig(8); "include" names others of its kind, as "folder/*.conf".
void read_configuration(const Machine& machine, const std::filesystem::path& file, int depth,
                        Folders& folders) {
    constexpr int deepest = 4;
    if (depth > deepest) return;
    std::istringstream lines(text_of(machine, file).value_or(""));
    for (std::string line; std::getline(lines, line);) {
        std::istringstream words(line.substr(0, line.find('#')));
        std::string word, pattern;
        if (!(words >> word)) continue;
        if (word != "include") {
            if (word.starts_with('/')) folders.emplace_back(word);
            continue;
        }
        if (!(words >> pattern)) continue;
        const std::filesystem::path named = file.parent_path() / pattern;
        std::error_code error;
        Folders included;
        for (const auto& entry :
             std::filesystem::directory_iterator(in_root(machine, named.parent_path()), error))
            if (entry.path().extension() == named.extension())
                included.push_back(named.parent_path() / entry.path().filename());
        std::ranges::sort(included);
        for (const auto& path : included) read_configuration(machine, path, depth + 1, folders);
    }
}

// The cache holds the path of every library it knows, each ended by a zero.
std::string read_cache(const Machine& machine) {
    std::ifstream file(in_root(machine, "/etc/ld.so.cache"), std::ios::binary);
    std::ostringstream text;
    text << file.rdbuf();
    return text.str();
}

Folders always_searched() {
    return {std::filesystem::path("/lib") / architecture, std::filesystem::path("/usr/lib") / architecture,
            "/lib", "/usr/lib"};
}

// Where installers put libraries though Debian's loader does not look there.
const Folders elsewhere{"/usr/lib64", "/usr/local/lib", "/usr/local/lib64"};

// The name itself or a longer one, as libHD.so.3.4.0 for libHD.so.3.4.
std::optional<std::filesystem::path> longer_name(const Machine& machine, const std::filesystem::path& folder,
                                                 const std::string& name) {
    Folders found;
    std::error_code error;
    for (const auto& entry : std::filesystem::directory_iterator(in_root(machine, folder), error)) {
        const std::string file = entry.path().filename().string();
        if (file == name || file.starts_with(name + ".")) found.push_back(folder / file);
    }
    return found.empty() ? std::nullopt : std::optional(*std::ranges::min_element(found));
}

}  // namespace

std::optional<LibraryPlace> library_at(const Machine& machine, const std::filesystem::path& file) {
    std::error_code error;
    const std::filesystem::path place = in_root(machine, file);
    if (!std::filesystem::exists(place, error)) return std::nullopt;
    LibraryPlace result{file, LibraryPlace::Standing::loads, {}, ""};
    try {
        result.elf = read_elf_file(place);
    } catch (const InvalidInput& damage) {
        result.standing = LibraryPlace::Standing::damaged;
        result.reason = damage.detail().found;
        return result;
    }
    if (!result.elf.for_this_machine) {
        result.standing = LibraryPlace::Standing::other_machine;
        result.reason = result.elf.machine;
    }
    return result;
}

std::optional<LibraryPlace> find_library(const Machine& machine, const std::string& name,
                                         const std::vector<std::string>& run_folders) {
    Folders first = split_folders(variable(machine, "LD_LIBRARY_PATH"));
    first.insert(first.end(), run_folders.begin(), run_folders.end());
    Folders configured;
    read_configuration(machine, "/etc/ld.so.conf", 0, configured);
    const Folders last = always_searched();
    const std::string cache = read_cache(machine);

    std::optional<LibraryPlace> second_best;
    const auto try_folder = [&](const std::filesystem::path& folder, bool must_be_cached) {
        auto place = library_at(machine, folder / name);
        if (!place) return std::optional<LibraryPlace>();
        const bool known = cache.find('\0' + place->file.string() + '\0') != std::string::npos;
        if (place->standing == LibraryPlace::Standing::loads && must_be_cached && !known)
            place->standing = LibraryPlace::Standing::not_cached;
        if (place->standing == LibraryPlace::Standing::loads) return place;
        if (!second_best) second_best = place;
        return std::optional<LibraryPlace>();
    };
    for (const auto& folder : first)
        if (auto place = try_folder(folder, false)) return place;
    for (const auto& folder : configured)
        if (auto place = try_folder(folder, std::ranges::find(last, folder) == last.end())) return place;
    for (const auto& folder : last)
        if (auto place = try_folder(folder, false)) return place;
    if (second_best) return second_best;
    const auto by_longer_name = [&](const Folders& folders, LibraryPlace::Standing standing) {
        for (const auto& folder : folders)
            if (const auto file = longer_name(machine, folder, name)) {
                second_best = library_at(machine, *file);
                if (second_best && second_best->standing == LibraryPlace::Standing::loads)
                    second_best->standing = standing;
                if (second_best) return;
            }
    };
    by_longer_name(configured, LibraryPlace::Standing::not_cached);
    if (!second_best) by_longer_name(last, LibraryPlace::Standing::not_cached);
    if (!second_best) by_longer_name(elsewhere, LibraryPlace::Standing::off_path);
    return second_best;
}

std::vector<std::string> run_folders_of(const LibraryPlace& library) {
    std::vector<std::string> folders = library.elf.run_folders;
    for (std::string& folder : folders)
        for (const std::string origin : {"$ORIGIN", "${ORIGIN}"})
            if (const std::size_t at = folder.find(origin); at != std::string::npos)
                folder.replace(at, origin.size(), library.file.parent_path().string());
    return folders;
}

}  // namespace palpate::doctor
