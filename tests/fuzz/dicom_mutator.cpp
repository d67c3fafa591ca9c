// SPDX-License-Identifier: GPL-3.0-or-later
// Mutations that know DICOM. An input is files one after the other; of one of their elements the header, the
// length or the value is changed, or it is left out or copied, a value also wherever its tag stands. Seven
// times of eight the lengths of what holds it are made to fit.
#include <algorithm>
#include <array>
#include <cstdint>
#include <cstring>
#include <random>
#include <span>
#include <string_view>
#include <vector>

extern "C" std::size_t LLVMFuzzerMutate(std::uint8_t* data, std::size_t size, std::size_t most);

namespace palpate::fuzz {
namespace {

using Bytes = std::vector<std::uint8_t>;

constexpr std::size_t preamble = 128, no_end = static_cast<std::size_t>(-1);
constexpr std::uint32_t item_tag = 0xfffee000, pixels_tag = 0x7fe00010, undefined = 0xffffffff;

std::uint32_t number_at(std::span<const std::uint8_t> bytes, std::size_t at, std::size_t width) {
    std::uint32_t value = 0;
    if (at + width <= bytes.size()) std::memcpy(&value, &bytes[at], width);
    return value;
}

void put(Bytes& bytes, std::size_t at, std::uint32_t value, std::size_t width) {
    if (at + width <= bytes.size()) std::memcpy(&bytes[at], &value, width);
}

struct Element {
    std::uint32_t tag;
    std::size_t at, value, end;           // where it begins, its value, what comes after it
    std::size_t length_at, length_width;  // of its length field
    std::vector<std::size_t> holders;     // indices of the sequences and items around it
    bool counts = false;                  // whether its length is defined
};

bool is_upper(std::uint8_t c) {
    return c >= 'A' && c <= 'Z';
}

// The elements of all files, those within sequences too, as far as they can be followed.
class Elements {
  public:
    explicit Elements(std::span<const std::uint8_t> bytes) : bytes_(bytes) {
        for (std::size_t at = 0; at + 8 <= bytes.size();) {
            if (begins_file(at)) {
                open_.clear();
                in_pixels_ = false;
                at += preamble + 4;
                continue;
            }
            at = take(at);
        }
    }
    const std::vector<Element>& found() const { return found_; }

  private:
    bool begins_file(std::size_t at) const {
        return at + preamble + 4 <= bytes_.size() && std::memcmp(&bytes_[at + preamble], "DICM", 4) == 0;
    }

    std::size_t take(std::size_t at) {
        while (!open_.empty() && found_[open_.back()].end <= at) open_.pop_back();
        Element element{
            number_at(bytes_, at, 2) << 16 | number_at(bytes_, at + 2, 2), at, at + 8, 0, at + 4, 4, {}};
        if (is_upper(bytes_[at + 4]) && is_upper(bytes_[at + 5])) {
            const std::string_view vr(reinterpret_cast<const char*>(&bytes_[at + 4]), 2);
            constexpr std::array<std::string_view, 8> long_ones{"OB", "OD", "OF", "OW",
                                                                "SQ", "UC", "UN", "UT"};
            const bool is_long = std::ranges::find(long_ones, vr) != long_ones.end();
            element.length_at = at + (is_long ? 8 : 6);
            element.length_width = is_long ? 4 : 2;
            element.value = at + (is_long ? 12 : 8);
        }
        const std::uint32_t length = number_at(bytes_, element.length_at, element.length_width);
        const bool group_of_items = element.tag >> 16 == 0xfffe;
        element.counts = length != undefined;
        element.holders = open_;
        const std::size_t after = element.value + length;
        element.end = element.counts ? std::min(after, bytes_.size()) : no_end;
        if (element.tag == pixels_tag) in_pixels_ = !element.counts;
        const bool holds = !element.counts || (element.tag == item_tag && !in_pixels_) ||
                           number_at(bytes_, element.value, 4) == 0xe000fffe;
        if (group_of_items && element.tag != item_tag) {  // a delimiter
            if (!open_.empty() && !found_[open_.back()].counts) open_.pop_back();
            if (in_pixels_) in_pixels_ = false;
        }
        found_.push_back(element);
        if (!holds) return std::max(found_.back().end, at + 8);
        if (element.tag != pixels_tag) open_.push_back(found_.size() - 1);
        return std::max(element.value, at + 8);
    }

    std::span<const std::uint8_t> bytes_;
    std::vector<Element> found_;
    std::vector<std::size_t> open_;
    bool in_pixels_ = false;
};

// Puts `value` in place of the bytes from `from` to `to`, and makes the lengths of holders fit if `fit`.
void replace(Bytes& bytes, const std::vector<Element>& all, const Element& element, std::size_t from,
             std::size_t to, const Bytes& value, bool fit) {
    to = std::min(to, bytes.size());  // what was replaced before may have held it
    from = std::min(from, to);
    const auto more = static_cast<std::uint32_t>(value.size() - (to - from));
    if (fit)
        for (const std::size_t holder : element.holders)
            if (const Element& h = all[holder]; h.counts)
                put(bytes, h.length_at, number_at(bytes, h.length_at, h.length_width) + more, h.length_width);
    bytes.erase(bytes.begin() + static_cast<std::ptrdiff_t>(from),
                bytes.begin() + static_cast<std::ptrdiff_t>(to));
    bytes.insert(bytes.begin() + static_cast<std::ptrdiff_t>(from), value.begin(), value.end());
}

class Mutation {
  public:
    Mutation(Bytes& bytes, std::size_t most, unsigned seed) : bytes_(bytes), most_(most), random_(seed) {}

    void run() {
        const std::vector<Element> all = Elements(bytes_).found();
        if (all.empty()) return anywhere();
        const Element& element = all[below(all.size())];
        fit_ = below(8) != 0;
        switch (below(8)) {
            case 0:
                return anywhere();
            case 1:
                return header(element);
            case 2:
                return length(element);
            case 3:
                return leave_out(all, element);
            case 4:
                return copy(all, element, all[below(all.size())]);
            default:
                return value(all, element);
        }
    }

  private:
    std::size_t below(std::size_t count) { return random_() % count; }

    void anywhere() {
        const std::size_t size = bytes_.size();
        bytes_.resize(std::max(most_, size));
        bytes_.resize(LLVMFuzzerMutate(bytes_.data(), size, most_));
    }

    void header(const Element& element) {
        LLVMFuzzerMutate(&bytes_[element.at], element.value - element.at, element.value - element.at);
    }

    void length(const Element& element) {
        const std::uint32_t now = number_at(bytes_, element.length_at, element.length_width),
                            rest = static_cast<std::uint32_t>(bytes_.size() -
                                                              std::min(bytes_.size(), element.value));
        const std::array<std::uint32_t, 9> lengths{undefined, 0xfffffffe, 0,        now + 1,   now - 1,
                                                   now * 2,   rest,       rest + 2, 0x7fffffff};
        put(bytes_, element.length_at, lengths[below(lengths.size())], element.length_width);
    }

    Bytes whole(const Element& element) const {
        const std::size_t end = std::min({element.end, bytes_.size(), element.at + most_ / 4});
        return {bytes_.begin() + static_cast<std::ptrdiff_t>(element.at),
                bytes_.begin() + static_cast<std::ptrdiff_t>(std::max(end, element.at))};
    }

    void leave_out(const std::vector<Element>& all, const Element& element) {
        replace(bytes_, all, element, element.at,
                std::min(element.end,
                         element.value + 4096 < bytes_.size() ? element.value + 4096 : bytes_.size()),
                {}, fit_);
    }

    void copy(const std::vector<Element>& all, const Element& from, const Element& before) {
        replace(bytes_, all, before, before.at, before.at, whole(from), fit_);
    }

    // A value of the usual or the worst kind for the tag, everywhere or at one place.
    void value(const std::vector<Element>& all, const Element& element) {
        if (element.value > bytes_.size()) return;
        const std::size_t end = std::min(element.end == no_end ? element.value : element.end, bytes_.size());
        Bytes changed(bytes_.begin() + static_cast<std::ptrdiff_t>(element.value),
                      bytes_.begin() + static_cast<std::ptrdiff_t>(std::max(end, element.value)));
        if (below(3) == 0) {
            constexpr std::array<std::string_view, 14> texts{"0",
                                                             "-1",
                                                             "1",
                                                             "2",
                                                             "65535",
                                                             "2147483647",
                                                             "1e308",
                                                             "1e-308",
                                                             "nan",
                                                             "",
                                                             "0\\0\\0",
                                                             "1\\0\\0\\0\\1\\0",
                                                             "1.2.840.10008.1.2.4.90",
                                                             std::string_view("\xff\xff", 2)};
            const std::string_view text = texts[below(texts.size())];
            changed.assign(text.begin(), text.end());
            if (changed.size() % 2 != 0) changed.push_back(element.length_width == 2 ? ' ' : 0);
        } else {
            const std::size_t size = changed.size();
            changed.resize(size + 64);
            changed.resize(LLVMFuzzerMutate(changed.data(), size, changed.size()));
        }
        const bool everywhere = below(2) == 0;
        for (std::size_t i = all.size(); i-- > 0;) {  // what comes later moves
            const Element& e = all[i];
            if (e.value > bytes_.size() || (&e != &element && !(everywhere && e.tag == element.tag &&
                                                                e.counts && e.end <= bytes_.size())))
                continue;
            const std::size_t stop = &e == &element ? std::max(end, e.value) : std::max(e.end, e.value);
            replace(bytes_, all, e, e.value, stop, changed, fit_);
            if (fit_ && e.counts)
                put(bytes_, e.length_at, static_cast<std::uint32_t>(changed.size()), e.length_width);
        }
    }

    Bytes& bytes_;
    std::size_t most_;
    std::minstd_rand random_;
    bool fit_ = true;
};

}  // namespace
}  // namespace palpate::fuzz

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
    std::vector<std::uint8_t> bytes(data, data + size);
    palpate::fuzz::Mutation(bytes, most, seed).run();
    bytes.resize(std::min(bytes.size(), most));
    std::ranges::copy(bytes, data);
    return bytes.size();
}
