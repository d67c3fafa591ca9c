// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "formats/model/body.hpp"

namespace palpate::asset {

/// Intermediate results between commands, in the asset's own schema, each with its digests.

/// Writes an OBB tree with the digest of the surface that it was built over (`.obb.h5`).
void write_obb_part(const std::filesystem::path& path, const ObbTree& tree, const TriangleMesh& surface);

/// Reads an OBB tree; throws InvalidInput if it was built over another surface than `surface`.
ObbTree read_obb_part(const std::filesystem::path& path, const TriangleMesh& surface);

/// Writes a condensed body without its OBB tree (`.body.h5`).
void write_body_part(const std::filesystem::path& path, const DeformableBody& body);

/// Reads a condensed body; throws InvalidInput as read_asset() does.
DeformableBody read_body_part(const std::filesystem::path& path);

}  // namespace palpate::asset
