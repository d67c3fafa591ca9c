// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <cstring>

namespace palpate::collision {

/// Four floats in one register (GCC and Clang), and what comparing them gives.
using Float4 = float __attribute__((vector_size(16)));
using Mask4 = std::int32_t __attribute__((vector_size(16)));
inline constexpr std::size_t lanes = 4;

inline Float4 load(const float* four) noexcept {
    Float4 value;
    std::memcpy(&value, four, sizeof(value));
    return value;
}

inline void store(const Float4& value, float* four) noexcept {
    std::memcpy(four, &value, sizeof(value));
}

inline Float4 root(const Float4& value) noexcept {
    Float4 result;
    for (int lane = 0; lane < 4; ++lane) result[lane] = std::sqrt(value[lane]);
    return result;
}

inline Float4 absolute(const Float4& value) noexcept {
    return value < 0 ? -value : value;
}

inline Float4 larger(const Float4& a, const Float4& b) noexcept {
    return a > b ? a : b;
}

inline bool any(const Mask4& mask) noexcept {
    std::uint64_t halves[2];
    std::memcpy(halves, &mask, sizeof(halves));
    return (halves[0] | halves[1]) != 0;
}

}  // namespace palpate::collision
