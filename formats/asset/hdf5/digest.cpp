// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/hdf5/digest.hpp"

#include <array>
#include <bit>
#include <fstream>
#include <memory>
#include <openssl/evp.h>

#include "formats/asset/hdf5/columns.hpp"
#include "formats/model/errors.hpp"

namespace palpate::asset {
namespace {

// Digests are of values as the asset stores them, and the asset is little-endian.
static_assert(std::endian::native == std::endian::little);

class Sha256 {
  public:
    Sha256() : context_(EVP_MD_CTX_new(), EVP_MD_CTX_free) {
        if (!context_ || EVP_DigestInit_ex(context_.get(), EVP_sha256(), nullptr) != 1) fail();
    }

    void add(const void* data, std::size_t size) {
        if (EVP_DigestUpdate(context_.get(), data, size) != 1) fail();
    }

    std::string hexadecimal() {
        std::array<unsigned char, 32> digest{};
        if (EVP_DigestFinal_ex(context_.get(), digest.data(), nullptr) != 1) fail();
        return to_hexadecimal(digest);
    }

  private:
    [[noreturn]] static void fail() {
        throw SystemFailure(
            {"libcrypto", "SHA-256 is not available", "", "check OpenSSL's configuration of providers"});
    }

    std::unique_ptr<EVP_MD_CTX, void (*)(EVP_MD_CTX*)> context_;
};

template <typename T>
std::string line(std::string_view name, const std::vector<T>& values) {
    return std::string(name) + ' ' + sha256(std::as_bytes(std::span(values))) + '\n';
}

}  // namespace

std::string to_hexadecimal(std::span<const unsigned char> bytes) {
    constexpr std::string_view digits = "0123456789abcdef";
    std::string text;
    for (const unsigned byte : bytes) {
        text += digits[byte >> 4];
        text += digits[byte & 15U];
    }
    return text;
}

std::string sha256(std::span<const std::byte> bytes) {
    Sha256 hash;
    hash.add(bytes.data(), bytes.size());
    return hash.hexadecimal();
}

std::string sha256(std::string_view text) {
    return sha256(std::as_bytes(std::span(text)));
}

std::string sha256_file(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    Sha256 hash;
    std::vector<char> buffer(std::size_t{1} << 20);
    while (stream) {
        stream.read(buffer.data(), static_cast<std::streamsize>(buffer.size()));
        hash.add(buffer.data(), static_cast<std::size_t>(stream.gcount()));
    }
    if (!stream.eof())
        throw InvalidInput({path.string(), "cannot be read", "", "check the path and its permissions"});
    return hash.hexadecimal();
}

std::string surface_digest(const TriangleMesh& surface) {
    return sha256(line("vertices", surface.vertices) + line("triangles", surface.triangles));
}

std::string mechanics_digest(const DeformableBody& body) {
    const MaterialColumns materials = columns_of(body.materials);
    std::string relaxation;
    if (!body.relaxation.empty()) {
        const RelaxationColumns columns = columns_of(body.relaxation);
        relaxation = line("relaxation_regions", columns.regions) + line("relaxation", columns.values);
    }
    return sha256(line("rest_positions", body.mesh.rest_positions) +
                  line("tetrahedra", body.mesh.tetrahedra) + line("regions", body.mesh.regions) +
                  line("material_regions", materials.regions) + line("materials", materials.values) +
                  relaxation + line("fixed_nodes", body.fixed_nodes) +
                  line("contact_nodes", body.contact_nodes) + "element_order " +
                  std::to_string(static_cast<std::int32_t>(body.element_order)) + '\n');
}

}  // namespace palpate::asset
