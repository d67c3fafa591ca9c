// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/model/body.hpp"

namespace palpate::asset {

/// Whether a reader recomputes every SHA-256 (0.5 s per GB) or trusts the bytes.
enum class Digests { check, skip };

/// Writes a case as one asset (formats/asset/SPEC.md) that ParaView opens too. Not atomic by itself: callers
/// write to a temporary name and rename. Throws InvalidInput if the parts do not belong together,
/// SystemFailure if the file cannot be written whole. With a private key it is signed; throws as
/// sign_manifest().
void write_asset(const std::filesystem::path& path, const Case& patient_case,
                 const std::filesystem::path& private_key = {});

/// Reads and validates an asset. Shapes are checked against the file's size before anything is allocated,
/// every index against its range, every number for finiteness; compliances are mapped, not copied, so the
/// file must not be shortened while one lives (replacing it by rename is safe). Throws InvalidInput naming
/// the file, the dataset and the remedy.
Case read_asset(const std::filesystem::path& path, Digests digests = Digests::check);

/// The same, digests checked, of an asset that one of the keys (read_public_keys()) must have signed; of any
/// without.
Case read_asset(const std::filesystem::path& path, std::span<const std::string> trusted_keys);

/// The key that an asset is signed by, and the signature holds; none if it is not signed. Digests are not
/// checked. Throws InvalidInput if the file is no asset or its signature is false.
std::optional<std::string> signer_of(const std::filesystem::path& path);

/// Reads and validates an asset as read_asset() does, and copies it whole, for a loop that must not fall when
/// the file is shortened or removed under it. With keys, one of them must have signed it.
Case load_asset(const std::filesystem::path& path, std::span<const std::string> trusted_keys = {});

/// The digest of everything in an asset, as the file says it; read_asset() checks it. Throws InvalidInput if
/// the file is no asset.
std::string asset_digest(const std::filesystem::path& path);

/// Writes to `scratch` (replaced) what was read from an asset, and returns where the asset is other than
/// that: its datasets by their paths, attributes by "path@name", those of them that write_asset() does not
/// write too, but for texts of variable length. What it does not write at all is left out, as a reader leaves
/// it out. Throws as write_asset(), and SystemFailure where `scratch` cannot be written.
std::vector<std::string> unlike_written_again(const std::filesystem::path& path, const Case& patient_case,
                                              const std::filesystem::path& scratch);

/// The datasets by their paths and the attributes by "path@name" in which two assets are not the same byte
/// for byte, signatures aside. Throws InvalidInput if one is no asset.
std::vector<std::string> differences(const std::filesystem::path& one, const std::filesystem::path& other);

}  // namespace palpate::asset
