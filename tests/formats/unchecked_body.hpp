// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <filesystem>

#include "formats/asset/body_io.hpp"
#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/validate.hpp"
#include "tests/formats/sample_case.hpp"

namespace palpate::sample {

// Cells enough for a tumour and an interior.
inline constexpr int cells = 4;

// The cube's compliance by blocks: clusters of 9 or 10 of the 73 contact nodes, low rank between distant
// ones.
inline DeformableBody hierarchical_cube() {
    return with_hierarchical_compliance(elastic_cube(cells), 3, 1e-4);
}

// What write_body_part() does, without its checks: digests are right, values need not be.
inline void write_unchecked(const std::filesystem::path& path, const DeformableBody& body) {
    using namespace asset;
    Hdf5Writer writer(path);
    write_header(writer, "body");
    write_condensed_body(writer, "/palpate/body", body, mechanics_digest(body));
    writer.finish("/palpate");
}

}  // namespace palpate::sample
