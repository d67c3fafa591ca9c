// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/parts.hpp"

#include <fstream>
#include <string_view>

#include "formats/asset/body_io.hpp"
#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/validate.hpp"

namespace palpate::asset {
namespace {

constexpr const char* tree_path = "/palpate/obb_tree";
constexpr const char* body_path = "/palpate/body";

}  // namespace

bool is_hdf5(const std::filesystem::path& path) {
    constexpr std::string_view signature = "\x89HDF\r\n\x1a\n";
    std::string head(signature.size(), '\0');
    std::ifstream(path, std::ios::binary).read(head.data(), static_cast<std::streamsize>(head.size()));
    return head == signature;
}

std::string kind_of(const std::filesystem::path& path) {
    return header_kind(Hdf5File(path));
}

void write_obb_part(const std::filesystem::path& path, const ObbTree& tree, const TriangleMesh& surface) {
    check_surface(surface, "surface");
    check_obb_tree(tree, surface.triangles.size(), "OBB tree");
    check_enclosure(tree, surface, "OBB tree");
    Hdf5Writer writer(path);
    write_header(writer, "obb_tree");
    write_obb_tree(writer, tree_path, tree, surface);
    writer.finish("/palpate");
}

ObbTree read_obb_part(const std::filesystem::path& path, const TriangleMesh& surface) {
    const Hdf5File file(path);
    check_header(file, "obb_tree");
    file.check_digests("/palpate");
    return read_obb_tree(file, tree_path, surface);
}

ObbPart read_obb_part(const std::filesystem::path& path) {
    const Hdf5File file(path);
    check_header(file, "obb_tree");
    file.check_digests("/palpate");
    return {read_obb_tree(file, tree_path), surface_digest_of_obb_tree(file, tree_path)};
}

void write_body_part(const std::filesystem::path& path, const DeformableBody& body) {
    check_body(body, "body '" + body.name + "'");
    Hdf5Writer writer(path);
    write_header(writer, "body");
    write_condensed_body(writer, body_path, body, mechanics_digest(body));
    writer.finish("/palpate");
}

DeformableBody read_body_part(const std::filesystem::path& path) {
    const Hdf5File file(path);
    check_header(file, "body");
    file.check_digests("/palpate");
    return read_condensed_body(file, body_path);
}

}  // namespace palpate::asset
