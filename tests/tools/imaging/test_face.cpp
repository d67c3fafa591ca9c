// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <gtest/gtest.h>

#include "tools/imaging/faces/face.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using namespace imaging;

// A head about the origin: a skull's shell with a sinus, brain, soft tissue 8 mm thick around it and a nose
// of 20 mm; the front is at -y, whichever way the index runs.
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
                const bool sinus = (p - Vector3d(0, -65, -20)).norm() < 12;
                volume.values.push_back(sinus                 ? -1000.0F
                                        : shell < 0.93        ? 35.0F
                                        : shell < 1           ? 900.0F
                                        : shell < 1.1 || nose ? 40.0F
                                                              : -1000.0F);
            }
    return volume;
}

TEST(Face, goes_and_leaves_bone_brain_and_the_back_of_the_head) {
    for (const bool index_to_the_front : {false, true}) {
        const Volume before = head(index_to_the_front);
        ASSERT_TRUE(shows_head(before));
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

// Few headers are wrong, but those that state nothing are taken for LPS.
TEST(Face, is_where_nose_and_sinuses_are_whatever_the_directions_say) {
    const Volume right = head(false);
    Volume wrong = right;
    wrong.grid.direction(1, 1) = -1;
    EXPECT_EQ(without_face(wrong).values, without_face(right).values);
}

// A trunk's section is a child's: spine, ribs, and no brain.
TEST(Face, is_not_in_a_trunk_however_small) {
    Volume trunk = head(false);
    for (std::size_t i = 0; i < trunk.values.size(); ++i) {
        const auto at = static_cast<std::int32_t>(i);
        const Vector3d p =
            trunk.grid.point_of(Vector3d(at % 176, at / 176 % 208, static_cast<double>(at / (176 * 208))));
        const double shell = std::hypot(p[0] / 90, p[1] / 70);
        const bool ribs = shell > 0.9 && shell < 1 && std::fmod(p[2] + 100, 25) < 8 && p[1] > -50;
        const bool spine = std::hypot(p[0], p[1] - 50) < 15;
        trunk.values[i] = ribs || spine ? 500.0F : shell < 1.1 ? 40.0F : -1000.0F;
    }
    EXPECT_FALSE(shows_head(trunk));
    EXPECT_FALSE(shows_face(trunk));
    EXPECT_EQ(without_face(trunk).values, trunk.values);
}

TEST(Face, is_found_in_a_body_with_a_head_which_is_no_head_alone) {
    Volume whole = head(false);
    EXPECT_TRUE(shows_head(whole));
    constexpr std::int32_t trunk_slices = 330;  // 825 mm below the head
    const std::size_t slice = std::size_t{176} * 208;
    for (std::size_t i = 0; i < 20 * slice; ++i)  // a neck
        if (std::hypot(static_cast<double>(i % 176) - 88, static_cast<double>(i % slice / 176) - 104) < 40)
            whole.values[i] = std::max(whole.values[i], 40.0F);
    std::vector<float> below;
    for (std::int32_t k = 0; k < trunk_slices; ++k)
        for (std::size_t at = 0; at < slice; ++at)
            below.push_back(
                std::hypot(static_cast<double>(at % 176) - 88, static_cast<double>(at / 176) - 104) < 80
                    ? 40.0F
                    : -1000.0F);
    whole.values.insert(whole.values.begin(), below.begin(), below.end());
    whole.grid.size[2] += trunk_slices;
    whole.grid.origin[2] -= 2.5 * trunk_slices;
    EXPECT_FALSE(shows_head(whole));
    EXPECT_TRUE(shows_face(whole));
    EXPECT_FALSE(shows_face(without_face(whole)));
}

}  // namespace
}  // namespace palpate
