// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/dicom/dicom_structure.hpp"

#include <algorithm>
#include <array>
#include <cstdint>
#include <fmt/format.h>
#include <fstream>
#include <string>
#include <string_view>
#include <utility>
#include <zlib.h>

#include "formats/model/errors.hpp"

namespace palpate::imaging {
namespace {

constexpr std::uint64_t dicom_preamble = 128;
constexpr std::uint32_t undefined_length = 0xffffffff;
constexpr std::uint32_t item_tag = 0xfffee000, item_end = 0xfffee00d, sequence_end = 0xfffee0dd,
                        pixels_tag = 0x7fe00010;

// A file, or what its deflated part unpacks to.
class DicomBytes {
  public:
    explicit DicomBytes(const std::filesystem::path& path) {
        stream_.rdbuf()->pubsetbuf(nullptr, 0);  // a buffer would be filled anew after each value
        stream_.open(path, std::ios::binary);
        stream_.seekg(0, std::ios::end);
        size_ = stream_ ? static_cast<std::uint64_t>(stream_.tellg()) : 0;
    }

    std::uint64_t size() const { return size_; }

    // Fewer than `count` only at the end.
    std::string read(std::uint64_t at, std::uint64_t count) {
        count = std::min(count, size_ - std::min(at, size_));
        if (!unpacked_.empty()) return unpacked_.substr(std::min(at, size_), count);
        std::string bytes(count, '\0');
        stream_.seekg(static_cast<std::streamoff>(at));
        stream_.read(bytes.data(), static_cast<std::streamsize>(count));
        return bytes;
    }

    // Goes on with what the bytes from `at` on unpack to; false if they cannot be unpacked.
    bool unpack(std::uint64_t at) {
        constexpr std::uint64_t most_times = 1100;  // more than deflate reaches
        const std::string packed = read(at, size_);
        z_stream z{};
        if (inflateInit2(&z, -MAX_WBITS) != Z_OK) return false;
        z.next_in = reinterpret_cast<Bytef*>(const_cast<char*>(packed.data()));
        z.avail_in = static_cast<uInt>(std::min<std::size_t>(packed.size(), undefined_length));
        std::string all;
        std::array<char, 1 << 14> block{};
        int state = Z_OK;
        while (state == Z_OK && all.size() <= most_times * packed.size()) {
            z.next_out = reinterpret_cast<Bytef*>(block.data());
            z.avail_out = block.size();
            state = inflate(&z, Z_NO_FLUSH);
            all.append(block.data(), block.size() - z.avail_out);
        }
        inflateEnd(&z);
        unpacked_ = std::move(all);
        size_ = unpacked_.size();
        return state == Z_STREAM_END && size_ > 0;
    }

  private:
    std::ifstream stream_;
    std::string unpacked_;
    std::uint64_t size_ = 0;
};

// How elements are written.
struct DicomCoding {
    bool with_types = true, big_endian = false;
};

struct WalkedElement {
    std::uint32_t tag = 0, length = 0;
    std::string type;  // empty where none is written
    std::uint64_t value = 0;
};

std::string tag_text(std::uint32_t tag) {
    return fmt::format("({:04x},{:04x})", tag >> 16, tag & 0xffffU);
}

bool has_long_length(std::string_view type) {
    constexpr std::array<std::string_view, 13> types{"OB", "OD", "OF", "OL", "OV", "OW", "SQ",
                                                     "SV", "UC", "UN", "UR", "UT", "UV"};
    return std::ranges::find(types, type) != types.end();
}

bool has_short_length(std::string_view type) {
    constexpr std::array<std::string_view, 21> types{"AE", "AS", "AT", "CS", "DA", "DS", "DT",
                                                     "FL", "FD", "IS", "LO", "LT", "PN", "SH",
                                                     "SL", "SS", "ST", "TM", "UI", "UL", "US"};
    return std::ranges::find(types, type) != types.end();
}

// A type that is not known is written as the long ones are (PS3.5, 7.1.2).
bool is_of_later_years(std::string_view type) {
    const auto capital = [](char c) { return c >= 'A' && c <= 'Z'; };
    return std::ranges::all_of(type, capital) && !has_short_length(type);
}

class DicomWalk {
  public:
    explicit DicomWalk(const std::filesystem::path& path) : path_(path), bytes_(path) {}

    void run() {
        const bool prefixed = bytes_.read(dicom_preamble, 4) == "DICM";
        std::uint64_t at = prefixed ? dicom_preamble + 4 : 0;
        std::string syntax;
        while (group_at(at) == 2) {
            const WalkedElement element = element_at(at, DicomCoding{}, bytes_.size());
            if (element.length == undefined_length) throw refuse(element, "has no length");
            if (element.tag == 0x00020010) syntax = text_of(element);
            at = element.value + element.length;
        }
        const DicomCoding coding = coding_of(syntax, at);
        if (!prefixed && group_at(at) != 8) throw refuse("does not begin as DICOM does");
        elements(at, bytes_.size(), coding, 0, 0, &header_);
        pixels_.syntax = syntax;
        pixels_.big_endian = coding.big_endian;
        check_pixels();
    }

    DicomSet header() { return std::move(header_); }

    DicomPixels pixels() {
        for (const WalkedElement& part : parts_)
            pixels_.parts.push_back(bytes_.read(part.value, part.length));
        if (pixels_.compressed) {  // the first item is the table
            pixels_.offsets = pixels_.parts.front();
            pixels_.parts.erase(pixels_.parts.begin());
        }
        return std::move(pixels_);
    }

  private:
    InvalidInput refuse(const std::string& found) const {
        return InvalidInput({path_.string(), "cannot be read, it is cut off or damaged: it " + found,
                             "a DICOM file that ends with its elements", "copy the file again"});
    }
    InvalidInput refuse(const WalkedElement& element, const std::string& found) const {
        return InvalidInput(
            {path_.string(),
             "cannot be read, it is cut off or damaged: element " + tag_text(element.tag) + " " + found,
             "a DICOM file that ends with its elements", "copy the file again"});
    }

    std::uint32_t number(std::uint64_t at, std::uint64_t width, bool big_endian) {
        std::string bytes = bytes_.read(at, width);
        if (big_endian) std::ranges::reverse(bytes);
        std::uint32_t value = 0;
        for (std::size_t i = bytes.size(); i-- > 0;)
            value = value << 8 | static_cast<unsigned char>(bytes[i]);
        return value;
    }

    std::uint32_t tag_at(std::uint64_t at, const DicomCoding& coding) {
        return number(at, 2, coding.big_endian) << 16 | number(at + 2, 2, coding.big_endian);
    }

    std::uint32_t group_at(std::uint64_t at) { return number(at, 2, false); }

    std::string text_of(const WalkedElement& element) {
        std::string text = bytes_.read(element.value, std::min<std::uint64_t>(element.length, 64));
        text.erase(text.find_last_not_of(std::string_view(" \0", 2)) + 1);
        return text;
    }

    // By the transfer syntax; by the first element where none is told. Unpacks what is deflated.
    DicomCoding coding_of(const std::string& syntax, std::uint64_t& at) {
        if (syntax == "1.2.840.10008.1.2") return {.with_types = false};
        if (syntax == "1.2.840.10008.1.2.2") return {.big_endian = true};
        if (syntax == "1.2.840.10008.1.2.1.99") {
            if (!bytes_.unpack(at)) throw refuse("cannot be unpacked");
            at = 0;
            return {};
        }
        compressed_ = syntax == "1.2.840.10008.1.2.5" || syntax.starts_with("1.2.840.10008.1.2.4.");
        if (compressed_ || syntax == "1.2.840.10008.1.2.1") return {};
        if (!syntax.empty())
            throw InvalidInput({path_.string(), "is written in the transfer syntax " + quoted(syntax),
                                "one of DICOM's", "convert it by 'gdcmconv --raw'"});
        const std::string type = bytes_.read(at + 4, 2);
        return {.with_types = has_long_length(type) || has_short_length(type)};
    }

    static std::string quoted(const std::string& text) {
        const bool uid = text.find_first_not_of("0123456789.") == std::string::npos;
        return uid ? text : "of no name";
    }

    // The element's head, whose value ends at `end` at the latest.
    WalkedElement element_at(std::uint64_t at, const DicomCoding& coding, std::uint64_t end) {
        WalkedElement element;
        element.tag = tag_at(at, coding);
        const bool of_items = element.tag >> 16 == 0xfffe;
        std::uint64_t head = 8;
        if (end - at >= head && coding.with_types && !of_items) {
            element.type = bytes_.read(at + 4, 2);
            if (has_long_length(element.type) || is_of_later_years(element.type))
                head = 12;
            else if (!has_short_length(element.type))
                throw refuse(element, "has a type that DICOM does not know");
        }
        if (end - at < head) throw refuse(element, "is cut off");
        const bool is_short = head == 8 && coding.with_types && !of_items;
        element.length =
            is_short ? number(at + 6, 2, coding.big_endian) : number(at + head - 4, 4, coding.big_endian);
        element.value = at + head;
        if (element.length != undefined_length && element.length > end - element.value)
            throw refuse(element, "is longer than what holds it");
        return element;
    }

    // Zeros to the file's end, as media and archives pad it.
    bool is_padding(std::uint64_t at) {
        constexpr std::uint64_t block = 1 << 16;
        if (number(at, 4, false) != 0) return false;
        for (; at < bytes_.size(); at += block)
            if (bytes_.read(at, block).find_first_not_of('\0') != std::string::npos) return false;
        return true;
    }

    // Elements from `at` to `end`, or to `delimiter` if that is not 0; returns where they end. `set` gets
    // what is kept of them, unless it is null.
    std::uint64_t elements(std::uint64_t at, std::uint64_t end, const DicomCoding& coding,
                           std::uint32_t delimiter, int depth, DicomSet* set) {
        while (at < end) {
            if (depth == 0 && is_padding(at)) return end;
            const WalkedElement element = element_at(at, coding, end);
            if (delimiter != 0 && element.tag == delimiter && element.length == 0) return element.value;
            if (element.tag >> 16 == 0xfffe) throw refuse(element, "stands where none of its kind may");
            at = value(element, end, coding, depth, set);
        }
        if (delimiter != 0) throw refuse("lacks the end of an item");
        return at;
    }

    // Follows a value; returns where it ends.
    std::uint64_t value(const WalkedElement& element, std::uint64_t end, const DicomCoding& coding, int depth,
                        DicomSet* set) {
        const bool open = element.length == undefined_length;
        const std::uint64_t value_end = open ? end : element.value + element.length;
        DicomValue* kept = keep(element, coding, set);
        if (depth == 0 && element.tag == pixels_tag) {
            pixels_.compressed = open;
            parts_.assign(open ? 0 : 1, element);
        }
        if (open && (element.type == "OB" || element.type == "OW")) return fragments(element, end, depth);
        const bool untyped = element.type.empty() || element.type == "UN";
        const DicomCoding inner = element.type == "UN" ? DicomCoding{.with_types = false} : coding;
        const bool begins_with_item = element.length >= 8 && tag_at(element.value, inner) == item_tag;
        if (open && element.type != "SQ" && !untyped) throw refuse(element, "has no length");
        if (open || element.type == "SQ" || (untyped && begins_with_item && element.tag != pixels_tag))
            return sequence(element, value_end, inner, open, depth + 1, kept);
        return value_end;
    }

    std::uint64_t sequence(const WalkedElement& holder, std::uint64_t end, const DicomCoding& coding,
                           bool open, int depth, DicomValue* kept) {
        constexpr int deepest = 32;
        if (depth > deepest)
            throw InvalidInput({path_.string(), fmt::format("has sequences more than {} deep", deepest),
                                "a file as a scanner or archive made it", "leave the file out"});
        std::uint64_t at = holder.value;
        while (at < end) {
            const std::uint32_t tag = tag_at(at, coding);
            if (tag != item_tag && tag != sequence_end) throw refuse(holder, "holds what is no item");
            const WalkedElement item = element_at(at, coding, end);
            if (open && item.tag == sequence_end && item.length == 0) return item.value;
            if (item.tag != item_tag) throw refuse(holder, "holds what is no item");
            const bool open_item = item.length == undefined_length;
            at = elements(item.value, open_item ? end : item.value + item.length, coding,
                          open_item ? item_end : 0, depth,
                          kept == nullptr ? nullptr : &kept->items.emplace_back());
        }
        if (open) throw refuse(holder, "has no end");
        return at;
    }

    // Where the value goes in `set`; null where it is not kept.
    DicomValue* keep(const WalkedElement& element, const DicomCoding& coding, DicomSet* set) {
        constexpr std::array<std::uint32_t, 4> groups{0x0008, 0x0020, 0x0028, 0x5200};
        if (set == nullptr || std::ranges::find(groups, element.tag >> 16) == groups.end()) return nullptr;
        const auto [at, is_new] = set->values.try_emplace(element.tag);
        if (!is_new) return nullptr;
        constexpr std::uint32_t longest = 4096;
        if (element.length <= longest) at->second.bytes = bytes_.read(element.value, element.length);
        at->second.big_endian = coding.big_endian;
        return &at->second;
    }

    // Compressed pixels: items of bytes.
    std::uint64_t fragments(const WalkedElement& holder, std::uint64_t end, int depth) {
        const bool of_file = depth == 0 && holder.tag == pixels_tag;
        std::uint64_t at = holder.value;
        for (int count = 0; at < end; ++count) {
            const WalkedElement item = element_at(at, DicomCoding{}, end);
            if (item.tag == sequence_end && item.length == 0 && count > 1) return item.value;
            if (item.tag != item_tag || item.length == undefined_length)
                throw refuse(holder, "holds what is no fragment");
            if (of_file) parts_.push_back(item);
            at = item.value + item.length;
        }
        throw refuse(holder, "has no end");
    }

    void check_pixels() const {
        if (parts_.empty()) return;
        if (compressed_ != pixels_.compressed)
            throw refuse("holds pixels that are not of its transfer syntax");
        std::uint64_t bits = 1;
        for (const std::uint32_t tag : {0x00280002U, 0x00280010U, 0x00280011U, 0x00280100U})
            bits *= unsigned_short(header_, tag);
        if (!compressed_ && bits > 8 * std::uint64_t{parts_.front().length})
            throw InvalidInput({path_.string(), "holds fewer voxels than its header claims", "",
                                "check that the file is whole"});
    }

    std::filesystem::path path_;
    DicomBytes bytes_;
    bool compressed_ = false;
    DicomSet header_;
    std::vector<WalkedElement> parts_;  // of the pixels
    DicomPixels pixels_;
};

}  // namespace

std::uint16_t unsigned_short(const DicomSet& set, std::uint32_t tag) {
    const auto found = set.values.find(tag);
    if (found == set.values.end() || found->second.bytes.size() < 2) return 0;
    const std::string& bytes = found->second.bytes;
    const auto first = static_cast<unsigned char>(bytes[0]), second = static_cast<unsigned char>(bytes[1]);
    return static_cast<std::uint16_t>(found->second.big_endian ? first << 8 | second : second << 8 | first);
}

void require_sound_dicom(const std::filesystem::path& path) {
    DicomWalk(path).run();
}

DicomSet read_dicom_header(const std::filesystem::path& path) {
    DicomWalk walk(path);
    walk.run();
    return walk.header();
}

DicomPixels read_dicom_pixels(const std::filesystem::path& path) {
    DicomWalk walk(path);
    walk.run();
    return walk.pixels();
}

}  // namespace palpate::imaging
