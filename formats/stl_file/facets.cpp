// SPDX-License-Identifier: Apache-2.0
#include "formats/stl_file/facets.hpp"

#include <algorithm>
#include <charconv>
#include <cmath>
#include <cstdint>
#include <cstring>
#include <sstream>
#include <utility>

#include "formats/model/errors.hpp"

namespace palpate::stl_file {
namespace {

constexpr std::size_t header_size = 80, counted_size = header_size + 4, facet_size = 50;
constexpr double farthest = 1e4;  // mm: no tool is 10 m long; what is, has other units

char lower(char c) {
    return c >= 'A' && c <= 'Z' ? static_cast<char>(c - 'A' + 'a') : c;
}

// `word`, in small letters, in any case.
bool says(std::string_view text, std::string_view word) {
    return std::ranges::equal(text, word, {}, lower);
}

std::uint32_t little_endian(std::string_view bytes, std::size_t at) {
    std::uint32_t value = 0;
    for (std::size_t i = 4; i-- > 0;) value = value << 8 | static_cast<unsigned char>(bytes[at + i]);
    return value;
}

std::size_t announced(std::string_view bytes) {
    return little_endian(bytes, header_size);
}

// `culprit` makes the name for a complaint.
float checked(double coordinate, const auto& culprit) {
    if (!std::isfinite(coordinate))
        throw InvalidInput({culprit(), "has a corner that is not finite", "", "write the file again"});
    if (std::abs(coordinate) > farthest) {
        std::ostringstream found;
        found << "has a corner with coordinate " << coordinate;
        throw InvalidInput({culprit(), found.str(), "10000 mm at most", "scale it to mm, about its tip"});
    }
    return static_cast<float>(coordinate) + 0.0F;  // of two zeros one
}

// Reads the words of a text, and knows the line that it is in.
class Words {
  public:
    Words(std::string_view text, std::string file) : text_(text), file_(std::move(file)) {}

    // The next word, "" at the end.
    std::string_view next() {
        while (at_ < text_.size() && is_space(text_[at_])) line_ += text_[at_++] == '\n';
        const std::size_t begin = at_;
        while (at_ < text_.size() && !is_space(text_[at_])) ++at_;
        return text_.substr(begin, at_ - begin);
    }

    void expect(std::string_view word) {
        if (const std::string_view found = next(); !says(found, word)) refuse(found, std::string(word));
    }

    float coordinate() {
        const std::string_view word = next();
        const std::string_view digits = word.starts_with('+') ? word.substr(1) : word;
        double value = 0;
        const auto [end, problem] = std::from_chars(digits.data(), digits.data() + digits.size(), value);
        if (problem != std::errc() || end != digits.data() + digits.size()) refuse(word, "a number");
        return checked(value, [this] { return place(); });
    }

    void skip_line() { at_ = std::min(text_.find_first_of("\r\n", at_), text_.size()); }

    [[noreturn]] void refuse(std::string_view found, const std::string& expected) const {
        constexpr std::size_t quoted = 20;
        std::string shown(found.substr(0, quoted));
        for (char& c : shown)
            if (c < ' ' || c > '~') c = '?';
        throw InvalidInput({place(), found.empty() ? "the text ends" : "finds \"" + shown + "\"", expected,
                            "write the file again, as binary STL"});
    }

  private:
    static bool is_space(char c) { return c == ' ' || (c >= '\t' && c <= '\r'); }
    std::string place() const { return file_ + ":" + std::to_string(line_); }

    std::string_view text_;
    std::string file_;
    std::size_t at_ = 0, line_ = 1;
};

// What follows "facet".
void read_facet(Words& words, std::vector<Corner>& corners) {
    words.expect("normal");
    for (int i = 0; i < 3; ++i) words.next();  // often not a number
    words.expect("outer");
    words.expect("loop");
    for (int i = 0; i < 3; ++i) {
        words.expect("vertex");
        Corner& corner = corners.emplace_back();
        for (float& x : corner) x = words.coordinate();
    }
    words.expect("endloop");
    words.expect("endfacet");
}

}  // namespace

bool is_binary(std::string_view bytes) {
    if (bytes.size() >= counted_size && bytes.size() == counted_size + facet_size * announced(bytes))
        return true;
    const std::string_view begin = bytes.substr(std::min(bytes.find_first_not_of(" \t\r\n"), bytes.size()));
    return !says(begin.substr(0, 5), "solid") || bytes.find('\0') != std::string_view::npos;
}

std::vector<Corner> binary_corners(std::string_view bytes, const std::string& file) {
    if (bytes.size() < counted_size)
        throw InvalidInput({file, "is no STL: has " + std::to_string(bytes.size()) + " bytes",
                            "84 or more, or a text that begins with \"solid\"", "check the path"});
    const std::size_t count = announced(bytes), expected = counted_size + facet_size * count;
    if (bytes.size() != expected)
        throw InvalidInput({file,
                            "has " + std::to_string(bytes.size()) + " bytes and announces " +
                                std::to_string(count) + " triangles",
                            std::to_string(expected) + " bytes", "write the file again"});
    std::vector<Corner> corners(3 * count);
    for (std::size_t i = 0; i < corners.size(); ++i)
        for (std::size_t axis = 0; axis < 3; ++axis) {
            // A facet is its normal, three corners, and two bytes of attributes.
            const std::size_t at = counted_size + facet_size * (i / 3) + 12 * (1 + i % 3) + 4 * axis;
            const std::uint32_t bits = little_endian(bytes, at);
            float value = 0;
            std::memcpy(&value, &bits, sizeof value);
            corners[i][axis] = checked(value, [&] { return file; });
        }
    return corners;
}

std::vector<Corner> ascii_corners(std::string_view text, const std::string& file) {
    std::vector<Corner> corners;
    Words words(text, file);
    words.expect("solid");
    words.skip_line();  // its name
    for (bool inside = true; true;) {
        const std::string_view word = words.next();
        if (!inside && word.empty()) return corners;
        if (inside && says(word, "facet")) {
            read_facet(words, corners);
        } else if (says(word, inside ? "endsolid" : "solid")) {
            inside = !inside;
            words.skip_line();
        } else {
            words.refuse(word, inside ? "\"facet\" or \"endsolid\"" : "\"solid\", or the end");
        }
    }
}

}  // namespace palpate::stl_file
