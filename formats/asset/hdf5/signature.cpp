// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/hdf5/signature.hpp"

#include <cstdio>
#include <memory>
#include <openssl/crypto.h>
#include <openssl/err.h>
#include <openssl/evp.h>
#include <openssl/pem.h>
#include <openssl/x509.h>
#include <optional>

#include "formats/asset/hdf5/digest.hpp"
#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"

namespace palpate::asset {
namespace {

using Key = std::unique_ptr<EVP_PKEY, void (*)(EVP_PKEY*)>;
using Context = std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)>;
using Stream = std::unique_ptr<std::FILE, int (*)(std::FILE*)>;
using Octets = std::vector<unsigned char>;

constexpr std::size_t key_bytes = 32, signature_bytes = 64;

[[noreturn]] void refuse_key(const std::filesystem::path& file, const char* kind, const char* remedy) {
    ERR_clear_error();
    throw InvalidInput(
        {file.string(), std::string("holds no ") + kind, "Ed25519 in PEM, without a passphrase", remedy});
}

Stream open_stream(const std::filesystem::path& file) {
    require_small_file(file, most_key_bytes);
    Stream stream(std::fopen(file.c_str(), "rb"), std::fclose);
    if (!stream)
        throw InvalidInput({file.string(), "cannot be read", "", "check the path and its permissions"});
    return stream;
}

// In place of asking at a terminal.
int no_passphrase(char*, int, int, void*) {
    return -1;
}

// Of `size` bytes, none otherwise.
Octets bytes_of(const std::string& digits, std::size_t size) {
    Octets bytes(size);
    std::size_t read = 0;
    const bool lower_case =
        std::ranges::none_of(digits, [](char digit) { return digit >= 'A' && digit <= 'F'; });
    const bool good = lower_case && digits.size() == 2 * size &&
                      OPENSSL_hexstr2buf_ex(bytes.data(), size, &read, digits.c_str(), '\0') == 1 &&
                      read == size;
    ERR_clear_error();
    return good ? bytes : Octets{};
}

// What is signed says what it is, so that a signature of this key for something else is none of an asset.
std::string message_of(std::string_view manifest_sha256) {
    return "palpate asset\nmanifest_sha256 " + std::string(manifest_sha256) + "\n";
}

const unsigned char* data_of(const std::string& text) {
    return reinterpret_cast<const unsigned char*>(text.data());
}

std::string public_part(EVP_PKEY* key) {
    Octets bytes(key_bytes);
    std::size_t size = bytes.size();
    if (EVP_PKEY_get_raw_public_key(key, bytes.data(), &size) != 1 || size != key_bytes)
        throw SystemFailure(
            {"libcrypto", "has no Ed25519", "", "check OpenSSL's configuration of providers"});
    return to_hexadecimal(bytes);
}

// The content of the next block of a PEM file; none at its end, or where it is broken.
std::optional<Octets> read_block(std::FILE* stream) {
    char *name = nullptr, *header = nullptr;
    unsigned char* data = nullptr;
    long size = 0;
    if (PEM_read(stream, &name, &header, &data, &size) != 1) return std::nullopt;
    Octets block(data, data + size);
    OPENSSL_free(name);
    OPENSSL_free(header);
    OPENSSL_free(data);
    return block;
}

}  // namespace

Signature sign_manifest(std::string_view manifest_sha256, const std::filesystem::path& private_key) {
    const Stream stream = open_stream(private_key);
    const Key key(PEM_read_PrivateKey(stream.get(), nullptr, no_passphrase, nullptr), EVP_PKEY_free);
    if (!key || EVP_PKEY_get_base_id(key.get()) != EVP_PKEY_ED25519)
        refuse_key(private_key, "private key",
                   "make one with 'openssl genpkey -algorithm ed25519 -out key.pem'");
    const std::string message = message_of(manifest_sha256);
    const Context context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
    Octets signature(signature_bytes);
    std::size_t size = signature.size();
    if (EVP_DigestSignInit(context.get(), nullptr, nullptr, nullptr, key.get()) != 1 ||
        EVP_DigestSign(context.get(), signature.data(), &size, data_of(message), message.size()) != 1)
        throw SystemFailure({"libcrypto", "cannot sign", "", "check OpenSSL's configuration of providers"});
    return {to_hexadecimal(signature), public_part(key.get())};
}

bool is_signed(std::string_view manifest_sha256, const Signature& signature) {
    const Octets bytes = bytes_of(signature.signature, signature_bytes),
                 key_part = bytes_of(signature.public_key, key_bytes);
    if (bytes.empty() || key_part.empty()) return false;
    const Key key(EVP_PKEY_new_raw_public_key(EVP_PKEY_ED25519, nullptr, key_part.data(), key_part.size()),
                  EVP_PKEY_free);
    const Context context(EVP_MD_CTX_new(), EVP_MD_CTX_free);
    const std::string message = message_of(manifest_sha256);
    const bool good =
        key && EVP_DigestVerifyInit(context.get(), nullptr, nullptr, nullptr, key.get()) == 1 &&
        EVP_DigestVerify(context.get(), bytes.data(), bytes.size(), data_of(message), message.size()) == 1;
    ERR_clear_error();
    return good;
}

std::vector<std::string> read_public_keys(std::span<const std::filesystem::path> files) {
    const char* remedy = "make one with 'openssl pkey -in key.pem -pubout -out key.pub.pem'";
    std::vector<std::string> keys;
    for (const auto& file : files) {
        const Stream stream = open_stream(file);
        const std::size_t before = keys.size();
        while (const auto block = read_block(stream.get())) {
            const unsigned char* start = block->data();
            const Key key(d2i_PUBKEY(nullptr, &start, static_cast<long>(block->size())), EVP_PKEY_free);
            if (!key || EVP_PKEY_get_base_id(key.get()) != EVP_PKEY_ED25519)
                refuse_key(file, "public keys alone", remedy);
            keys.push_back(public_part(key.get()));
        }
        const bool at_end = ERR_GET_REASON(ERR_peek_last_error()) == PEM_R_NO_START_LINE;
        if (keys.size() == before || !at_end) refuse_key(file, "public key that is whole", remedy);
        ERR_clear_error();
    }
    return keys;
}

}  // namespace palpate::asset
