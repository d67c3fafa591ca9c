// SPDX-License-Identifier: GPL-3.0-or-later
// Headers of NIfTI, NRRD and MetaImage: fields of free text, and what stands in the others.
#include <algorithm>
#include <array>
#include <cctype>
#include <cstring>
#include <fmt/format.h>
#include <regex>
#include <set>

#include "tools/archive/privacy/searches.hpp"

namespace palpate::archive {
namespace {

std::string text_until_zero(std::string_view bytes) {
    std::string text(bytes.substr(0, bytes.find('\0')));
    while (!text.empty() && std::isspace(static_cast<unsigned char>(text.back())) != 0) text.pop_back();
    return text;
}

struct HeaderField {
    const char* name;
    std::size_t offset, length;
};

// nifti1.h and nifti2.h.
constexpr std::array<HeaderField, 5> nifti1_fields{{{"data_type", 4, 10},
                                                    {"db_name", 14, 18},
                                                    {"descrip", 148, 80},
                                                    {"aux_file", 228, 24},
                                                    {"intent_name", 328, 16}}};
constexpr std::array<HeaderField, 3> nifti2_fields{
    {{"descrip", 240, 80}, {"aux_file", 320, 24}, {"intent_name", 508, 16}}};

// A field that says of a patient what it says, or free text; numbers and words of the format are neither.
void search_field(const std::string& name, const std::string& value, const std::filesystem::path& file,
                  const Machine& machine, Findings& findings) {
    static const std::regex identifying(
        R"(patient|subject|study|series|accession|institution|hospital|physician|operator|birth|date|time|\buid\b|comment|^name$|[0-9a-f]{4}\|[0-9a-f]{4})",
        std::regex::icase);
    if (value.empty()) return;
    if (std::regex_search(name, identifying))
        findings.push_back({file, "field " + name, "header field", shortened(value)});
    else
        search_text(value, file, "field " + name, false, machine, findings);
}

std::string_view next_line(std::string_view& bytes) {
    const std::size_t end = std::min(bytes.find('\n'), bytes.size());
    std::string_view line = bytes.substr(0, end);
    bytes.remove_prefix(std::min(end + 1, bytes.size()));
    if (line.ends_with('\r')) line.remove_suffix(1);
    return line;
}

std::string without_blanks(std::string_view text) {
    const auto first = text.find_first_not_of(" \t");
    if (first == std::string_view::npos) return {};
    return std::string(text.substr(first, text.find_last_not_of(" \t") + 1 - first));
}

}  // namespace

void search_nifti(std::string_view bytes, const std::filesystem::path& file, const Machine& machine,
                  Findings& findings) {
    const auto free_text = [&](const std::string& where, const std::string& value) {
        if (!value.empty()) findings.push_back({file, where, "header field", shortened(value)});
    };
    std::int32_t size = 0;
    if (bytes.size() < 352) return;
    std::memcpy(&size, bytes.data(), 4);
    const bool second = size == 540 || size == 0x1C020000;
    const auto take = [&](const HeaderField& field) {
        if (field.offset + field.length <= bytes.size())
            free_text(std::string("field ") + field.name,
                      text_until_zero(bytes.substr(field.offset, field.length)));
    };
    if (second)
        std::ranges::for_each(nifti2_fields, take);
    else
        std::ranges::for_each(nifti1_fields, take);
    // Extensions, up to the voxels.
    const std::size_t start = second ? 544 : 352;
    double offset = 0;
    if (second) {
        std::int64_t whole = 0;
        std::memcpy(&whole, bytes.data() + 168, 8);
        offset = static_cast<double>(whole);
    } else {
        float stored = 0;
        std::memcpy(&stored, bytes.data() + 108, 4);
        offset = stored;
    }
    if (!(offset > static_cast<double>(start)) || offset > static_cast<double>(bytes.size())) return;
    std::string extensions(bytes.substr(start, static_cast<std::size_t>(offset) - start));
    std::ranges::replace_if(
        extensions, [](char c) { return c == '\0'; }, '\n');
    search_text(extensions, file, "header extension, ", true, machine, findings);
}

void search_nrrd(std::string_view bytes, const std::filesystem::path& file, const Machine& machine,
                 Findings& findings) {
    for (int number = 1; !bytes.empty(); ++number) {
        const std::string_view line = next_line(bytes);
        if (line.empty()) return;
        if (line.starts_with('#')) {
            const std::string comment = without_blanks(line.substr(1));
            if (!comment.empty() && !comment.starts_with("Complete NRRD file format specification at") &&
                !comment.starts_with("http://teem.sourceforge.net/"))
                findings.push_back(
                    {file, fmt::format("line {}, a comment", number), "header field", shortened(comment)});
            continue;
        }
        const std::size_t key = line.find(":="), field = line.find(": ");
        if (key != std::string_view::npos && key < field) {
            search_field(std::string(line.substr(0, key)), without_blanks(line.substr(key + 2)), file,
                         machine, findings);
        } else if (field != std::string_view::npos) {
            const std::string name(line.substr(0, field)), value = without_blanks(line.substr(field + 2));
            if (name == "content" && !value.empty())
                findings.push_back({file, "field content", "header field", shortened(value)});
            else
                search_text(value, file, "field " + name, false, machine, findings);
        }
    }
}

void search_metaimage(std::string_view bytes, const std::filesystem::path& file, const Machine& machine,
                      Findings& findings) {
    while (!bytes.empty()) {
        const std::string_view line = next_line(bytes);
        const std::size_t equals = line.find('=');
        if (equals == std::string_view::npos) return;
        const std::string name = without_blanks(line.substr(0, equals));
        search_field(name, without_blanks(line.substr(equals + 1)), file, machine, findings);
        if (name == "ElementDataFile") return;
    }
}

}  // namespace palpate::archive
