// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/elf_file.hpp"

#include <algorithm>
#include <cctype>
#include <cstdint>
#include <cstring>
#include <elf.h>
#include <fstream>
#include <optional>
#include <string_view>

#include "formats/model/errors.hpp"

namespace palpate::doctor {
namespace {

#if defined(__aarch64__)
constexpr int own_machine = EM_AARCH64;
#else
constexpr int own_machine = EM_X86_64;
#endif
constexpr std::uint64_t most_segments = 1024, most_entries = 65536, longest_text = 4096;

class Reader {
  public:
    explicit Reader(const std::filesystem::path& path) : path_(path) {
        std::error_code error;
        if (!std::filesystem::is_regular_file(path, error)) refuse("is not a file");
        file_.open(path, std::ios::binary);
        size_ = std::filesystem::file_size(path, error);
        if (!file_ || error) refuse("cannot be read");
    }

    [[noreturn]] void refuse(const std::string& found) const {
        throw InvalidInput(
            {path_.string(), found, "a whole shared library (ELF)", "install the library again"});
    }

    void read(std::uint64_t offset, void* data, std::uint64_t bytes) {
        if (offset > size_ || bytes > size_ - offset) refuse("ends before what it announces");
        file_.seekg(static_cast<std::streamoff>(offset));
        if (!file_.read(static_cast<char*>(data), static_cast<std::streamsize>(bytes)))
            refuse("cannot be read");
    }

    template <typename T>
    std::vector<T> table(std::uint64_t offset, std::uint64_t entries, std::uint64_t most) {
        if (entries > most) refuse("has a table of " + std::to_string(entries) + " entries");
        std::vector<T> result(entries);
        read(offset, result.data(), entries * sizeof(T));
        return result;
    }

    std::string text(std::uint64_t offset) {
        if (offset > size_) refuse("names a text beyond its end");
        std::string result(std::min(longest_text, size_ - offset), '\0');
        read(offset, result.data(), result.size());
        const std::size_t end = result.find('\0');
        if (end == std::string::npos) refuse("has a text without end");
        result.resize(end);
        // It will stand on a terminal, in JSON and in shell lines.
        const bool plain = std::ranges::all_of(result, [](char c) {
            return std::isalnum(static_cast<unsigned char>(c)) ||
                   std::string_view("._+-/:${}~@").find(c) != std::string_view::npos;
        });
        if (!plain) refuse("names what is no file name");
        return result;
    }

  private:
    std::filesystem::path path_;
    std::ifstream file_;
    std::uint64_t size_ = 0;
};

std::string machine_name(int machine, bool bits_64) {
    const std::string bits = bits_64 ? ", 64 bit" : ", 32 bit";
    if (machine == EM_X86_64) return "x86-64" + bits;
    if (machine == EM_386) return "i386" + bits;
    if (machine == EM_AARCH64) return "aarch64" + bits;
    return "machine " + std::to_string(machine) + bits;
}

std::uint64_t file_offset(const std::vector<Elf64_Phdr>& segments, std::uint64_t address,
                          const Reader& reader) {
    for (const Elf64_Phdr& segment : segments)
        if (segment.p_type == PT_LOAD && address >= segment.p_vaddr &&
            address - segment.p_vaddr < segment.p_filesz &&
            segment.p_offset <= UINT64_MAX - (address - segment.p_vaddr))
            return segment.p_offset + (address - segment.p_vaddr);
    reader.refuse("points outside of what it loads");
}

std::vector<std::string> folders(const std::string& list) {
    std::vector<std::string> result;
    for (std::size_t start = 0; start <= list.size();) {
        const std::size_t end = std::min(list.find(':', start), list.size());
        if (end > start) result.push_back(list.substr(start, end - start));
        start = end + 1;
    }
    return result;
}

void read_dynamic(Reader& reader, const Elf64_Ehdr& header, ElfFile& result) {
    const auto segments = reader.table<Elf64_Phdr>(header.e_phoff, header.e_phnum, most_segments);
    const auto dynamic = std::ranges::find(segments, Elf64_Word{PT_DYNAMIC}, &Elf64_Phdr::p_type);
    if (dynamic == segments.end()) reader.refuse("has no dynamic section");
    const auto entries =
        reader.table<Elf64_Dyn>(dynamic->p_offset, dynamic->p_filesz / sizeof(Elf64_Dyn), most_entries);
    const auto end = std::ranges::find(entries, Elf64_Sxword{DT_NULL}, &Elf64_Dyn::d_tag);
    const auto entry = [&](Elf64_Sxword tag) {
        const auto found = std::find_if(entries.begin(), end, [&](const auto& e) { return e.d_tag == tag; });
        return found == end ? std::nullopt : std::optional(found->d_un.d_val);
    };
    const auto texts = entry(DT_STRTAB), texts_size = entry(DT_STRSZ);
    if (!texts || !texts_size) reader.refuse("has no table of texts");
    const std::uint64_t table = file_offset(segments, *texts, reader);
    const auto text = [&](std::uint64_t index) {
        if (index >= *texts_size || table > UINT64_MAX - index)
            reader.refuse("names a text beyond its table");
        return reader.text(table + index);
    };
    for (auto e = entries.begin(); e != end; ++e)
        if (e->d_tag == DT_NEEDED) result.needed.push_back(text(e->d_un.d_val));
    if (const auto run_path = entry(DT_RUNPATH))
        result.run_folders = folders(text(*run_path));
    else if (const auto old_run_path = entry(DT_RPATH))
        result.run_folders = folders(text(*old_run_path));
}

}  // namespace

ElfFile read_elf_file(const std::filesystem::path& path) {
    Reader reader(path);
    Elf64_Ehdr header{};
    reader.read(0, &header, EI_NIDENT + 4);  // as far as both word sizes agree
    if (std::memcmp(header.e_ident, ELFMAG, SELFMAG) != 0) reader.refuse("is not an ELF file");
    ElfFile result;
    const bool bits_64 = header.e_ident[EI_CLASS] == ELFCLASS64;
    result.machine = machine_name(header.e_machine, bits_64);
    if (!bits_64 || header.e_ident[EI_DATA] != ELFDATA2LSB || header.e_machine != own_machine) return result;
    if (header.e_type != ET_DYN) reader.refuse("is not a shared library");
    result.for_this_machine = true;
    reader.read(0, &header, sizeof(header));
    if (header.e_phentsize != sizeof(Elf64_Phdr)) reader.refuse("has segments of unknown size");
    read_dynamic(reader, header, result);
    return result;
}

}  // namespace palpate::doctor
