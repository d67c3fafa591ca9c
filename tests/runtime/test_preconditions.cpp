// SPDX-License-Identifier: Apache-2.0
// What headers call asserted ends the program in builds with assertions: presets dev, asan and tsan.
#include <gtest/gtest.h>
#include <limits>

#include "formats/model/compliance.hpp"
#include "formats/model/image_grid.hpp"
#include "runtime/devices/dynamics/dynamic_device.hpp"
#include "runtime/devices/mounted_device.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "runtime/haptics/methods/published_contact.hpp"
#include "runtime/openigtlink/contact_point.hpp"
#include "tests/runtime/haptics/held_tool.hpp"

namespace palpate {
namespace {

using namespace devices;

#ifdef NDEBUG
#define EXPECT_ASSERTED(statement) \
    if (false) {                   \
        statement;                 \
    }                              \
    GTEST_SKIP() << "this build has no assertions"
#else
#define EXPECT_ASSERTED(statement) EXPECT_DEATH(statement, "Assertion")
#endif

HandPath resting() {
    return HandPath({{0, Eigen::Vector3d::Zero(), true}});
}

const SurfaceCompliance& cube_compliance() {
    static const Case cube = soft_cube(2);
    return cube.deformable_bodies[0].compliance;
}

TEST(Preconditions, blocks_of_a_compliance_are_between_its_nodes) {
    const std::int32_t beyond = node_count(cube_compliance());
    EXPECT_ASSERTED(compliance_block(cube_compliance(), 0, beyond));
}

TEST(Preconditions, displacements_are_as_many_as_the_compliances_nodes) {
    std::vector<Eigen::Vector3f> short_by_one(static_cast<std::size_t>(node_count(cube_compliance()) - 1));
    EXPECT_ASSERTED(add_displacements(cube_compliance(), {}, short_by_one));
}

TEST(Preconditions, directions_of_a_grid_are_orthonormal) {
    ImageGrid grid;
    grid.direction *= 2;
    EXPECT_ASSERTED(grid.index_of({0, 0, 0}));
}

TEST(Preconditions, a_device_is_given_a_finite_force) {
    DynamicDevice device(find_device_model("touch"), {}, resting());
    EXPECT_ASSERTED(device.write({{0, 0, std::numeric_limits<double>::quiet_NaN()}}));
}

TEST(Preconditions, a_device_is_held_by_a_hand) {
    EXPECT_ASSERTED(DynamicDevice(find_device_model("touch"), {}, std::shared_ptr<Hand>()));
}

TEST(Preconditions, a_device_is_mounted_by_a_rigid_motion) {
    DynamicDevice device(find_device_model("touch"), {}, resting());
    Eigen::Isometry3d mirrored = Eigen::Isometry3d::Identity();
    mirrored.linear()(0, 0) = -1;
    EXPECT_ASSERTED(MountedDevice(device, mirrored));
}

TEST(Preconditions, a_mounted_device_is_there) {
    EXPECT_ASSERTED(MountedDevice(std::unique_ptr<realtime::Device>(), Eigen::Isometry3d::Identity()));
}

TEST(Preconditions, a_tick_has_as_many_devices_and_results_as_tools) {
    haptics::HapticModel model(plate());
    TickResult result;
    EXPECT_ASSERTED(model.tick(std::span<const realtime::DeviceState>(), {&result, 1}));
}

TEST(Preconditions, a_contacts_vertices_are_the_bodys) {
    Contact contact{};
    contact.vertices = {5, -1, -1};
    EXPECT_ASSERTED(openigtlink::contact_point(contact, {}));
}

}  // namespace
}  // namespace palpate
