// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <algorithm>
#include <array>
#include <bit>
#include <cstdint>
#include <cstring>
#include <filesystem>
#include <string>
#include <string_view>

namespace palpate::meshing {

/// A file read into memory and taken apart from front to back: words between white space, numbers, raw bytes.
/// Everything that is not there or not as asked for throws InvalidInput naming the file and the line.
class Scanner {
  public:
    explicit Scanner(const std::filesystem::path& path);

    bool at_end();                                          ///< after white space
    bool exhausted() const { return at_ == text_.size(); }  ///< without that
    std::string_view word();                                ///< the next word
    std::string_view peek();                                ///< the next word, which stays; empty at the end
    std::string_view text() const { return text_; }         ///< all of it
    std::string_view line();    ///< the rest of this line; the next reading starts below it
    std::string_view quoted();  ///< what stands between the next two '"'
    std::int64_t integer();     ///< the next word as a whole number
    std::int64_t count();       ///< a number of things that the rest of the file has room for
    /// `value` if it fits 32 bits; throws naming `what` if not.
    std::int32_t narrow(std::int64_t value, const char* what) const;
    double number();                      ///< the next word as a number; it may begin with '+'
    bool skip_to(std::string_view text);  ///< moves behind the next `text`; false, unmoved, if there is none

    /// The next bytes as a value.
    template <typename T>
    T raw(std::endian order = std::endian::native) {
        std::array<char, sizeof(T)> bytes;
        std::memcpy(bytes.data(), take(sizeof(T)), sizeof(T));
        if (order != std::endian::native) std::ranges::reverse(bytes);
        return std::bit_cast<T>(bytes);
    }
    /// Throws unless there are as many bytes left as `count` things of at least `bytes` each take.
    std::int64_t require_room(std::int64_t count, std::size_t bytes);
    /// Moves behind `count` things of `bytes` each; throws as require_room() does.
    void skip(std::int64_t count, std::size_t bytes);

    [[noreturn]] void fail(const std::string& found, const std::string& expected = "",
                           const std::string& next_step = "") const;

  private:
    const char* take(std::size_t bytes);

    std::string path_, text_;
    std::size_t at_ = 0;
};

}  // namespace palpate::meshing
