// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <bit>

#include "formats/asset/hdf5/byte_cursor.hpp"

namespace palpate::asset {
namespace {

struct State {
    std::uint32_t a, b, c;

    void add(std::span<const std::byte> block) {
        std::array<std::uint32_t, 3> words{};  // a last, shorter block counts as padded with zeros
        std::memcpy(words.data(), block.data(), block.size());
        a += words[0];
        b += words[1];
        c += words[2];
    }

    void mix() {
        a = (a - c) ^ std::rotl(c, 4), c += b;
        b = (b - a) ^ std::rotl(a, 6), a += c;
        c = (c - b) ^ std::rotl(b, 8), b += a;
        a = (a - c) ^ std::rotl(c, 16), c += b;
        b = (b - a) ^ std::rotl(a, 19), a += c;
        c = (c - b) ^ std::rotl(b, 4), b += a;
    }

    void finish() {
        c = (c ^ b) - std::rotl(b, 14);
        a = (a ^ c) - std::rotl(c, 11);
        b = (b ^ a) - std::rotl(a, 25);
        c = (c ^ b) - std::rotl(b, 16);
        a = (a ^ c) - std::rotl(c, 4);
        b = (b ^ a) - std::rotl(a, 14);
        c = (c ^ b) - std::rotl(b, 24);
    }
};

}  // namespace

std::uint32_t lookup3(std::span<const std::byte> bytes) {
    const std::uint32_t start = 0xdeadbeefU + static_cast<std::uint32_t>(bytes.size());
    State state{start, start, start};
    constexpr std::size_t block = 12;
    for (; bytes.size() > block; bytes = bytes.subspan(block)) {
        state.add(bytes.first(block));
        state.mix();
    }
    if (bytes.empty()) return state.c;
    state.add(bytes);
    state.finish();
    return state.c;
}

}  // namespace palpate::asset
