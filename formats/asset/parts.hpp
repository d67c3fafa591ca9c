// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <string>

#include "formats/model/body.hpp"

namespace palpate::asset {

/// Intermediate results between commands, in the asset's own schema, each with its digests.

/// Tells whether a file is HDF5 by its first bytes.
bool is_hdf5(const std::filesystem::path& path);

/// What an HDF5 file of palpate's says it is: "case", "body" or "obb_tree". Throws InvalidInput if it is no
/// file of palpate's.
std::string kind_of(const std::filesystem::path& path);

/// Writes an OBB tree with the digest of the surface that it was built over (`.obb.h5`).
void write_obb_part(const std::filesystem::path& path, const ObbTree& tree, const TriangleMesh& surface);

/// Reads an OBB tree; throws InvalidInput if it was built over another surface than `surface`.
ObbTree read_obb_part(const std::filesystem::path& path, const TriangleMesh& surface);

/// An OBB tree whose surface is not at hand.
struct ObbPart {
    ObbTree tree;
    std::string surface_sha256;  ///< surface_digest() of the surface that it was built over
};

/// Reads an OBB tree by itself; throws InvalidInput as read_asset() does.
ObbPart read_obb_part(const std::filesystem::path& path);

/// Writes a condensed body without its OBB tree (`.body.h5`).
void write_body_part(const std::filesystem::path& path, const DeformableBody& body);

/// Reads a condensed body; throws InvalidInput as read_asset() does.
DeformableBody read_body_part(const std::filesystem::path& path);

}  // namespace palpate::asset
