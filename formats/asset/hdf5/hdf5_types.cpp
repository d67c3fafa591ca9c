// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/hdf5/hdf5_types.hpp"

#include "formats/asset/hdf5/digest.hpp"

namespace palpate::asset {

std::string manifest_digest(const std::map<std::string, std::string>& manifest) {
    std::string lines;
    for (const auto& [key, digest] : manifest) lines += key + ' ' + digest + '\n';
    return sha256(lines);
}

bool in_manifest(std::string_view attribute) {
    return attribute != "sha256" && attribute != "manifest_sha256" && attribute != "signature" &&
           attribute != "public_key";
}

}  // namespace palpate::asset
