// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <gtest/gtest.h>
#include <string>

#include "tests/tools/refusal_of.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace palpate::test {

/// What refusal_of() gives of reading a volume.
template <typename Refusal = InvalidInput>
std::string volume_refusal(const std::filesystem::path& path, const imaging::ReadOptions& options = {}) {
    return refusal_of<Refusal>([&] { imaging::read_volume(path, {}, options); });
}

// Of float32 affines (NIfTI) and decimal headers: 100 mm at 2^-24 relative, over a few terms.
inline constexpr double header_tolerance = 5e-5;

/// Four corners of a grid of 4 x 5 x 6 voxels lie where they are expected.
inline void expect_same_place(const ImageGrid& found, const ImageGrid& expected) {
    ASSERT_EQ(found.size, expected.size);
    for (const Eigen::Vector3d& index : {Eigen::Vector3d(0, 0, 0), Eigen::Vector3d(3, 0, 0),
                                         Eigen::Vector3d(0, 4, 0), Eigen::Vector3d(0, 0, 5)})
        EXPECT_LT((found.point_of(index) - expected.point_of(index)).norm(), header_tolerance);
}

}  // namespace palpate::test

#define EXPECT_SAYS(text, phrase) EXPECT_NE((text).find(phrase), std::string::npos) << (text)
