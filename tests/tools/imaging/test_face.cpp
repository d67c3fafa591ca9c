// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>

#include "tools/imaging/faces/face.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using namespace imaging;

// A body of elliptic sections, in air, on a table.
Volume body(double half_width, double half_depth) {
    Volume volume;
    volume.grid = {.size = {100, 100, 20}, .spacing = {4, 4, 8}, .origin = {-198, -198, 0}};
    for (int k = 0; k < 20; ++k)
        for (int j = 0; j < 100; ++j)
            for (int i = 0; i < 100; ++i) {
                const Vector3d p = volume.grid.point_of(Vector3d(i, j, k));
                const bool inside = std::hypot(p[0] / half_width, p[1] / half_depth) < 1;
                volume.values.push_back(inside ? 40 : p[1] > 170 && p[1] < 180 ? 100 : -1000);
            }
    return volume;
}

TEST(Head, is_told_from_a_trunk_by_its_sections) {
    EXPECT_TRUE(shows_head(body(75, 95)));
    EXPECT_FALSE(shows_head(body(150, 105)));
    Volume stored = body(75, 95);
    for (float& value : stored.values) value += 1024;
    EXPECT_TRUE(shows_head(stored)) << "as value + 1024";
}

// A head about the origin: a skull's shell, brain, soft tissue 8 mm thick around it and a nose of 20 mm; the
// front is at -y, whichever way the index runs.
Volume head(bool index_to_the_front) {
    Volume volume;
    volume.grid = {.size = {176, 208, 72}, .spacing = {1.25, 1.25, 2.5}, .origin = {-110, -130, -90}};
    if (index_to_the_front) {
        volume.grid.direction(1, 1) = -1;
        volume.grid.origin[1] = 128.75;
    }
    for (int k = 0; k < 72; ++k)
        for (int j = 0; j < 208; ++j)
            for (int i = 0; i < 176; ++i) {
                const Vector3d p = volume.grid.point_of(Vector3d(i, j, k));
                const double shell = Vector3d(p[0] / 70, p[1] / 90, p[2] / 80).norm();
                const bool nose = std::hypot(p[0], p[2] + 20) < 14 && p[1] < -80 && p[1] > -115;
                volume.values.push_back(shell < 0.93          ? 35.0F
                                        : shell < 1           ? 900.0F
                                        : shell < 1.1 || nose ? 40.0F
                                                              : -1000.0F);
            }
    return volume;
}

TEST(Face, goes_and_leaves_bone_brain_and_the_back_of_the_head) {
    for (const bool index_to_the_front : {false, true}) {
        const Volume before = head(index_to_the_front);
        ASSERT_TRUE(shows_face(before));
        const Volume after = without_face(before);
        EXPECT_FALSE(shows_face(after));
        std::size_t soft_in_front = 0, changed_elsewhere = 0, offset = 0;
        for (int k = 0; k < 72; ++k)
            for (int j = 0; j < 208; ++j)
                for (int i = 0; i < 176; ++i, ++offset) {
                    const Vector3d p = before.grid.point_of(Vector3d(i, j, k));
                    const double shell = Vector3d(p[0] / 70, p[1] / 90, p[2] / 80).norm();
                    if (shell > 1.04 && p[1] < -60) soft_in_front += after.values[offset] > -300;
                    if (shell < 0.97 || p[1] > 5)
                        changed_elsewhere += after.values[offset] != before.values[offset];
                }
        EXPECT_EQ(soft_in_front, 0U);
        EXPECT_EQ(changed_elsewhere, 0U);
    }
}

TEST(Face, is_not_in_a_trunk) {
    EXPECT_FALSE(shows_face(body(150, 105)));
}

}  // namespace
}  // namespace palpate
