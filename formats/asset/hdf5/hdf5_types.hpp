// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <map>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

namespace palpate::asset {

/// The element types that an asset may use; all little-endian. `text` is of fixed length; `variable_text`
/// occurs below /VTKHDF/FieldData alone, for VTK 9.1, which reads no other: it is neither read nor part of
/// the manifest.
enum class ScalarType { uint8, int16, int32, int64, float32, float64, text, variable_text };

template <typename T>
constexpr ScalarType scalar_type() {
    if constexpr (std::is_same_v<T, std::uint8_t>)
        return ScalarType::uint8;
    else if constexpr (std::is_same_v<T, std::int16_t>)
        return ScalarType::int16;
    else if constexpr (std::is_same_v<T, std::int32_t>)
        return ScalarType::int32;
    else if constexpr (std::is_same_v<T, std::int64_t>)
        return ScalarType::int64;
    else if constexpr (std::is_same_v<T, float>)
        return ScalarType::float32;
    else {
        static_assert(std::is_same_v<T, double>);
        return ScalarType::float64;
    }
}

using Hdf5Shape = std::vector<std::uint64_t>;

/// Digest of the manifest: the SHA-256 of the lines "key sha256\n" in ascending order of keys.
std::string manifest_digest(const std::map<std::string, std::string>& manifest);

/// Whether an attribute is part of the manifest: all are, but those that hold the digests.
bool in_manifest(std::string_view attribute);

}  // namespace palpate::asset
