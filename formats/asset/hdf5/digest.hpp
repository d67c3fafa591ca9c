// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>

#include "formats/model/body.hpp"

namespace palpate::asset {

/// Two lower-case hexadecimal digits a byte.
std::string to_hexadecimal(std::span<const unsigned char> bytes);

/// SHA-256 as 64 lower-case hexadecimal digits. About 2 GB/s where the CPU has SHA instructions.
std::string sha256(std::span<const std::byte> bytes);
std::string sha256(std::string_view text);

/// SHA-256 of a file's content; throws InvalidInput if it cannot be read.
std::string sha256_file(const std::filesystem::path& path);

/// Digest of a surface's vertices and triangles; ties an OBB tree to its surface.
std::string surface_digest(const TriangleMesh& surface);

/// Digest of what a compliance follows from: nodes, tetrahedra, regions, materials with their relaxation,
/// fixed and contact nodes, element order.
std::string mechanics_digest(const DeformableBody& body);

}  // namespace palpate::asset
