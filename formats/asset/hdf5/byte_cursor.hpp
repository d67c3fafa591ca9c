// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <span>
#include <stdexcept>

namespace palpate::asset {

/// Thrown by ByteCursor where bytes end too early; the parser turns it into an InvalidInput.
class EndOfBytes : public std::runtime_error {
  public:
    EndOfBytes() : std::runtime_error("bytes end too early") {}
};

/// Reads little-endian numbers off a span of bytes, never beyond its end.
class ByteCursor {
  public:
    explicit ByteCursor(std::span<const std::byte> bytes) : bytes_(bytes) {}

    std::size_t remaining() const { return bytes_.size(); }

    std::span<const std::byte> take(std::uint64_t count) {
        if (count > bytes_.size()) throw EndOfBytes();
        const auto taken = bytes_.first(static_cast<std::size_t>(count));
        bytes_ = bytes_.subspan(taken.size());
        return taken;
    }

    template <std::unsigned_integral T>
    T number() {
        T value;
        std::memcpy(&value, take(sizeof(T)).data(), sizeof(T));
        return value;
    }

    /// A number of 1, 2, 4 or 8 bytes, as `code` 0, 1, 2 or 3 says.
    std::uint64_t sized_number(unsigned code) {
        switch (code & 3U) {
            case 0:
                return number<std::uint8_t>();
            case 1:
                return number<std::uint16_t>();
            case 2:
                return number<std::uint32_t>();
            default:
                return number<std::uint64_t>();
        }
    }

  private:
    std::span<const std::byte> bytes_;
};

/// Jenkins' lookup3 hash with which HDF5 closes its headers (Jenkins 2006, hashlittle).
std::uint32_t lookup3(std::span<const std::byte> bytes);

}  // namespace palpate::asset
