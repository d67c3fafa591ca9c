// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/files/scanner.hpp"

#include <algorithm>
#include <charconv>
#include <fmt/format.h>
#include <fstream>
#include <iterator>
#include <utility>

#include "formats/model/errors.hpp"

namespace palpate::meshing {
namespace {

constexpr std::string_view white = " \t\r\n\v\f";

}  // namespace

Scanner::Scanner(const std::filesystem::path& path) : path_(path.string()) {
    if (!std::filesystem::is_regular_file(path))
        throw InvalidInput({path_, "no such file", "", "check the path"});
    std::ifstream stream(path, std::ios::binary);
    text_.assign(std::istreambuf_iterator<char>(stream), {});
    if (!stream) throw InvalidInput({path_, "cannot be read", "", "check that it is a file you may read"});
}

bool Scanner::at_end() {
    at_ = std::min(text_.find_first_not_of(white, at_), text_.size());
    return at_ == text_.size();
}

std::string_view Scanner::peek() {
    if (at_end()) return {};
    return std::string_view(text_).substr(at_, std::min(text_.find_first_of(white, at_), text_.size()) - at_);
}

std::string_view Scanner::word() {
    const std::string_view found = peek();
    if (found.empty()) fail("ends too early", "", "write the file again");
    at_ += found.size();
    return found;
}

std::string_view Scanner::line() {
    const std::size_t end = std::min(text_.find('\n', at_), text_.size());
    const std::string_view found = std::string_view(text_).substr(at_, end - at_);
    at_ = std::min(end + 1, text_.size());
    return found;
}

std::string_view Scanner::quoted() {
    const std::size_t open = text_.find('"', at_);
    const std::size_t close = open == std::string::npos ? open : text_.find('"', open + 1);
    if (close == std::string::npos) fail("a name without its two quotation marks");
    at_ = close + 1;
    return std::string_view(text_).substr(open + 1, close - open - 1);
}

std::int64_t Scanner::integer() {
    const std::string_view text = word();
    std::int64_t value = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
        fail(fmt::format("'{}'", text.substr(0, 40)), "a whole number", "write the file again");
    return value;
}

std::int64_t Scanner::count() {
    return require_room(integer(), 2);
}

std::int32_t Scanner::narrow(std::int64_t value, const char* what) const {
    if (!std::in_range<std::int32_t>(value))
        fail(fmt::format("{} {}", what, value), "a number of 32 bits", "renumber it where it was made");
    return static_cast<std::int32_t>(value);
}

double Scanner::number() {
    const std::string_view text = word();
    double value = 0;
    const auto sign = static_cast<std::size_t>(text.size() > 1 && text[0] == '+' && text[1] != '-');
    const auto [end, error] = std::from_chars(text.data() + sign, text.data() + text.size(), value);
    if (error != std::errc{} || end != text.data() + text.size())
        fail(fmt::format("'{}'", text.substr(0, 40)), "a number", "write the file again");
    return value;
}

bool Scanner::skip_to(std::string_view text) {
    const std::size_t found = text_.find(text, at_);
    if (found == std::string::npos) return false;
    at_ = found + text.size();
    return true;
}

std::int64_t Scanner::require_room(std::int64_t count, std::size_t bytes) {
    if (count < 0 || static_cast<std::uint64_t>(count) > (text_.size() - at_) / bytes)
        fail(fmt::format("announces {} entries, for which the file is too short", count), "",
             "write the file again");
    return count;
}

void Scanner::skip(std::int64_t count, std::size_t bytes) {
    at_ += static_cast<std::size_t>(require_room(count, bytes)) * bytes;
}

const char* Scanner::take(std::size_t bytes) {
    if (text_.size() - at_ < bytes) fail("ends too early", "", "write the file again");
    at_ += bytes;
    return text_.data() + at_ - bytes;
}

void Scanner::fail(const std::string& found, const std::string& expected,
                   const std::string& next_step) const {
    const auto line = 1 + std::count(text_.begin(), text_.begin() + static_cast<std::ptrdiff_t>(at_), '\n');
    throw InvalidInput({fmt::format("{}:{}", path_, line), found, expected, next_step});
}

}  // namespace palpate::meshing
