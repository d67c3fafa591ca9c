// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/archive/objects/dicom_uid.hpp"

#include <algorithm>
#include <array>

#include "formats/asset/hdf5/digest.hpp"

namespace palpate::archive {

std::string uid_of(const std::string& digest, std::string_view role) {
    const std::string hash = asset::sha256(digest + '\n' + std::string(role));
    std::array<unsigned, 16> bytes{};
    for (std::size_t i = 0; i < bytes.size(); ++i)
        bytes[i] = static_cast<unsigned>(std::stoul(hash.substr(2 * i, 2), nullptr, 16));
    bytes[6] = (bytes[6] & 0x0FU) | 0x80U;  // version 8
    bytes[8] = (bytes[8] & 0x3FU) | 0x80U;  // variant of the RFC
    std::string decimal;
    while (std::ranges::any_of(bytes, [](unsigned byte) { return byte != 0; })) {
        unsigned rest = 0;
        for (unsigned& byte : bytes) {
            const unsigned value = rest * 256 + byte;
            byte = value / 10;
            rest = value % 10;
        }
        decimal.push_back(static_cast<char>('0' + rest));
    }
    std::ranges::reverse(decimal);
    return "2.25." + decimal;
}

}  // namespace palpate::archive
