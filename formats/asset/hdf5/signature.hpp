// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace palpate::asset {

/// Who made an asset, told by Ed25519 (RFC 8032) over its manifest's digest, and so over all of it. Digests
/// by themselves reveal damage; whoever changes a file can make them anew, but no signature.

/// A signature and the key that judges it, as hexadecimal digits: 64 bytes and 32.
struct Signature {
    std::string signature;
    std::string public_key;
};

/// What a file with a key may have; of a pipe nobody knows whether its writer comes.
inline constexpr std::uintmax_t most_key_bytes = 1 << 16;

/// Signs a manifest's digest with a private key, a PEM file as `openssl genpkey -algorithm ed25519` writes
/// it, without a passphrase. The same key and digest give the same signature. Throws InvalidInput for
/// what is no file, is larger than most_key_bytes or holds no such key.
Signature sign_manifest(std::string_view manifest_sha256, const std::filesystem::path& private_key);

/// Whether the signature is the public key's, of that digest.
bool is_signed(std::string_view manifest_sha256, const Signature& signature);

/// Reads public keys from PEM files, as `openssl pkey -pubout` writes them, one or more in each; 64
/// hexadecimal digits a key. Throws InvalidInput for a file without one, one larger than
/// most_key_bytes, what is no file, and for keys of other kinds.
std::vector<std::string> read_public_keys(std::span<const std::filesystem::path> files);

}  // namespace palpate::asset
