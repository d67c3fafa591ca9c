// SPDX-License-Identifier: GPL-3.0-or-later
// What the hand feels against a direct sparse solve of the same contact: the whole way from mesh to force.
#include <Eigen/Cholesky>
#include <gtest/gtest.h>

#include "formats/model/contact/compliance_blocks.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "tests/tools/fem/blocks.hpp"
#include "tests/tools/fem/certificate/direct_press.hpp"
#include "tools/fem/condensation/condense.hpp"
#include "tools/obb/build_obb_tree.hpp"

namespace palpate {
namespace {

using namespace haptics;

// Stored compliances are float32 and contacts carry float32 weights and normals: 1e-6 relative each, a few of
// them.
constexpr double float_tolerance = 1e-5;

Case pressed_case() {
    Case patient;
    patient.name = "block";
    DeformableBody body =
        test::held_block({8, 8, 5}, {40, 40, 25}, {.youngs_modulus = 6.3e-3, .poissons_ratio = 0.45});
    test::jitter_interior(body.mesh, 0.8, 5);
    body = fem::condensed_body(body, [](std::string_view, double) {});
    body.obb_tree = obb::build_obb_tree(body.boundary.surface);
    patient.deformable_bodies.push_back(body);
    patient.haptics.tool_radius = 6;  // mm, wider than the mesh, so that several vertices carry
    return patient;
}

// Brings the tool from above to `depth` below the top face at (x, y), 0.02 mm a tick, and returns every tick.
std::vector<TickResult> press(HapticModel& model, double x, double y, double depth) {
    const double top = 25, radius = model.settings().tool_radius, start = 1, step = 0.02;
    std::vector<TickResult> results;
    const auto move_to = [&](double lowest_point) {
        realtime::DeviceState device;
        device.position = {x, y, top + radius + lowest_point};
        TickResult result;
        model.tick(device, result);
        results.push_back(result);
    };
    for (double z = start; z > -depth; z -= step) move_to(z);
    for (double z = -depth; z < start; z += step) move_to(z);
    return results;
}

std::vector<test::DirectContact> direct_contacts(const DeformableBody& body,
                                                 std::span<const Contact> contacts) {
    const LoadSpread spread(body, compliance_blocks(body));
    std::vector<test::DirectContact> result;
    for (const Contact& contact : contacts) {
        test::DirectContact point{
            {}, {}, {contact.normal[0], contact.normal[1], contact.normal[2]}, contact.series_compliance};
        for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i) {
            point.nodes.push_back(body.boundary.nodes[static_cast<std::size_t>(contact.vertices[i])]);
            point.weights.push_back(contact.weights[i]);
        }
        result.push_back(test::spread_over(body, spread, point));
    }
    return result;
}

TEST(Press, force_equals_a_direct_sparse_solve_of_the_same_contact) {
    const Case patient = pressed_case();
    HapticModel model(patient);
    const auto results = press(model, 19.0, 22.0, 3.0);
    const TickResult& deepest = results[results.size() / 2 - 1];
    const auto contacts = deepest.active_contacts();
    ASSERT_GE(contacts.size(), 1U);
    ASSERT_NEAR(deepest.depth, 3.0, 0.05);

    const DeformableBody& body = patient.deformable_bodies[0];
    const Eigen::MatrixXd A =
        test::direct_compliance(body, direct_contacts(body, contacts), model.coupling());
    std::vector<bool> active;
    Eigen::VectorXd felt(contacts.size()), delta(contacts.size());
    for (std::size_t k = 0; k < contacts.size(); ++k) {
        felt[static_cast<Eigen::Index>(k)] = double{contacts[k].force};
        delta[static_cast<Eigen::Index>(k)] = double{contacts[k].gap};
        active.push_back(contacts[k].force > 0);
    }
    const Eigen::VectorXd exact = test::direct_forces(A, delta, active);
    for (Eigen::Index k = 0; k < felt.size(); ++k) {
        EXPECT_GE(exact[k], 0);
        EXPECT_NEAR(exact[k], felt[k], float_tolerance * exact.sum());
    }
    EXPECT_NEAR(exact.sum(), felt.sum(), float_tolerance * exact.sum());
    // Points without force have given way far enough: nothing is left inside the tool.
    EXPECT_GT((A * felt - delta).minCoeff(), -1e-4);
}

TEST(Press, force_grows_with_depth_and_vanishes_on_release) {
    const Case patient = pressed_case();
    HapticModel model(patient);
    const auto results = press(model, 19.0, 22.0, 3.0);
    const std::size_t half = results.size() / 2;
    double last = 0;
    for (std::size_t i = 0; i < half; ++i) {
        EXPECT_GE(results[i].force[2], last - 1e-9) << "at depth " << results[i].depth;
        last = results[i].force[2];
    }
    EXPECT_GT(last, 0.05);  // N; a 6 mm sphere 3 mm deep in tissue of 6.3 kPa
    EXPECT_EQ(results.back().force[2], 0);
    EXPECT_EQ(results.back().contact_count, 0);
}

TEST(Press, a_stiffer_inclusion_raises_the_force_over_it) {
    Case plain = pressed_case(), with_tumour = pressed_case();
    DeformableBody& body = with_tumour.deformable_bodies[0];
    for (std::size_t t = 0; t < body.mesh.tetrahedra.size(); ++t) {
        Eigen::Vector3d centre = Eigen::Vector3d::Zero();
        for (const std::int32_t node : body.mesh.tetrahedra[t])
            centre += body.mesh.rest_positions[static_cast<std::size_t>(node)] / 4;
        if ((centre - Eigen::Vector3d(20, 20, 17)).norm() < 6) body.mesh.regions[t] = 2;
    }
    body.mesh.region_names.push_back({2, "tumour", {1, 0, 0}});
    body.materials.push_back({2, {.youngs_modulus = 30e-3, .poissons_ratio = 0.45}});
    const ObbTree tree = body.obb_tree;
    body = fem::condensed_body(body, [](std::string_view, double) {});
    body.obb_tree = tree;
    HapticModel soft(plain), hard(with_tumour);
    const auto peak = [](const std::vector<TickResult>& results) {
        return results[results.size() / 2 - 1].force[2];
    };
    // Spread over 13 mm, the load feels the inclusion of 12 mm less than it is.
    EXPECT_GT(peak(press(hard, 20, 20, 3)), 1.05 * peak(press(soft, 20, 20, 3)));
}

}  // namespace
}  // namespace palpate
