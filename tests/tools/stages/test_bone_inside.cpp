// SPDX-License-Identifier: GPL-3.0-or-later
#include <gmock/gmock.h>

#include "tools/stages/bone_inside.hpp"

namespace palpate {
namespace {

using namespace stages;
using Eigen::Vector3d;
using testing::HasSubstr;

// A box of 20 mm in six tetrahedra.
TetMesh box() {
    TetMesh mesh;
    for (int corner = 0; corner < 8; ++corner)
        mesh.rest_positions.emplace_back(20 * (corner & 1), 20 * (corner >> 1 & 1), 20 * (corner >> 2 & 1));
    mesh.regions.assign(6, 1);
    mesh.tetrahedra = {{0, 1, 3, 7}, {0, 3, 2, 7}, {0, 2, 6, 7}, {0, 6, 4, 7}, {0, 4, 5, 7}, {0, 5, 1, 7}};
    return mesh;
}

// Around it by 3 mm, of voxels many of whose middles lie between two tetrahedra: bone where x < 4 mm.
Scan ct(double bone_hu) {
    Scan scan;
    scan.grid = {.size = {26, 26, 26}, .spacing = {1, 1, 1}, .origin = {-2.5, -2.5, -2.5}};
    scan.hounsfield = true;
    for (int k = 0; k < 26; ++k)
        for (int j = 0; j < 26; ++j)
            for (int i = 0; i < 26; ++i)
                scan.values.push_back(
                    static_cast<std::int16_t>(scan.grid.point_of(Vector3d(i, j, k)).x() < 4 ? bone_hu : 50));
    return scan;
}

TEST(BoneInside, is_what_of_the_mesh_a_ct_shows_as_dense) {
    const BoneInside found = bone_inside(box(), ct(700));
    EXPECT_DOUBLE_EQ(found.volume, 4 * 20 * 20);  // mm^3
    EXPECT_DOUBLE_EQ(found.share, 0.2);
    EXPECT_THAT(bone_text(found), HasSubstr("holds 1.6 ml (20 %) of 300 HU and more"));
}

TEST(BoneInside, is_none_of_soft_tissue_or_an_image_that_is_not_in_hu) {
    EXPECT_EQ(bone_inside(box(), ct(290)).volume, 0);
    Scan grey = ct(700);
    grey.hounsfield = false;
    EXPECT_EQ(bone_inside(box(), grey).volume, 0);
    EXPECT_EQ(bone_text(bone_inside(box(), grey)), "");
}

TEST(BoneInside, is_not_spoken_of_where_it_is_little) {
    EXPECT_EQ(bone_text({.volume = 400, .share = 0.2}), "");
    EXPECT_EQ(bone_text({.volume = 4000, .share = 0.004}), "");
}

}  // namespace
}  // namespace palpate
