// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>

#include "runtime/collision/collision_surface.hpp"
#include "runtime/haptics/contact/equilibrium/deformed_patch.hpp"
#include "tests/runtime/elastic_cube.hpp"

namespace palpate::haptics {
namespace {

using Eigen::Vector3d;

class DeformedPatchTest : public ::testing::Test {
  protected:
    static constexpr int unseen = 40;  // ticks after which a vertex that bears nothing has gone

    // Where a force (N) on one vertex alone leads another to, as the first answer has it.
    static Vector3d answered(DeformedPatch& patch, std::int32_t loaded, std::int32_t looked_at) {
        const std::int32_t from = patch.slot_of(loaded), to = patch.slot_of(looked_at);
        patch.begin_hold(0);
        patch.end_hold(0);
        patch.begin_answer(0);
        patch.load_answer(0, from, {0, 0, -0.01});
        patch.end_answer(0);
        std::array<double, DeformedPatch::iterates> first{};
        first[0] = 1;
        patch.relax_to(first, 1);
        const Vector3d moved = patch.displacement(to);
        patch.release();
        return moved;
    }

    const DeformableBody cube_ = sample::true_elastic_cube(3);
    const collision::CollisionSurface surface_{cube_.boundary.surface, cube_.obb_tree, cube_.name};
    const DeformableContact body_{cube_, surface_, 1, 0, false};
};

// A vertex that an answer loaded leaves, another takes its place, and a third that one's.
TEST_F(DeformedPatchTest, forgets_what_answers_loaded_a_vertex_with_that_has_gone) {
    const std::int32_t gone = 10, stays = 20, comes = 30;
    DeformedPatch patch(body_);
    patch.begin_tick();
    const std::int32_t first = patch.slot_of(gone), second = patch.slot_of(stays);
    patch.begin_answer(0);
    patch.load_answer(0, first, {0, 0, -1});
    patch.load_answer(0, second, {0, 0, -1});
    for (int tick = 0; tick < unseen; ++tick) {
        patch.begin_tick();
        patch.slot_of(stays);
    }
    ASSERT_FALSE(patch.is_in(gone));
    ASSERT_TRUE(patch.is_in(stays));
    DeformedPatch fresh(body_);
    fresh.begin_tick();
    EXPECT_EQ(answered(patch, comes, stays), answered(fresh, comes, stays));
}

}  // namespace
}  // namespace palpate::haptics
