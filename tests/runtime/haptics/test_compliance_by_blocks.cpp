// SPDX-License-Identifier: Apache-2.0
// Touching a body whose compliance is stored by blocks.
#include <algorithm>
#include <cmath>
#include <gtest/gtest.h>
#include <memory>
#include <numeric>
#include <random>
#include <utility>
#include <variant>
#include <vector>

#include "formats/model/contact/compliance_blocks.hpp"
#include "runtime/haptics/contact/load_spread.hpp"
#include "runtime/haptics/haptic_model.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/allocation_trap.hpp"
#include "tests/runtime/elastic_cube.hpp"
#include "tests/runtime/haptics/held_tool.hpp"
#include "tests/runtime/samples.hpp"

namespace palpate {
namespace {

using namespace haptics;
using Eigen::Vector3d;
using Eigen::Vector3f;

Case holding(DeformableBody body) {
    Case c;
    c.name = "cube";
    c.deformable_bodies.push_back(std::move(body));
    c.haptics = {.tool_radius = 3, .coupling_stiffness = 0.5, .max_force = 50, .max_force_rate = 50};
    return c;
}

// Contact nodes in no order at all: nodes that the tool touches at once lie in distant clusters, so that
// their coupling comes out of blocks of low rank.
DeformableBody by_scattered_blocks(DeformableBody body, double accuracy) {
    std::vector<std::int32_t> order(body.contact_nodes.size());
    std::iota(order.begin(), order.end(), 0);
    std::shuffle(order.begin(), order.end(), std::mt19937(11));
    constexpr int depth = 4;
    body.compliance =
        sample::hierarchical(std::get<DenseCompliance>(body.compliance), order, depth, accuracy);
    return body;
}

void go(HapticModel& model, TickResult& result, const Vector3d& p) {
    realtime::DeviceState state;
    state.position = {p[0], p[1], p[2]};
    model.tick(state, result);
}

std::vector<Vector3f> displacements(const HapticModel& model, const TickResult& result,
                                    const DeformableBody& body) {
    std::vector<Vector3f> u(body.boundary.nodes.size(), Vector3f::Constant(9));  // what was there must go
    model.surface_displacement(0, result, u);
    return u;
}

// A press of several contacts, and one at the edge.
const std::vector<Vector3d> presses{{10.3, 9.4, 21.5}, {8.1, 8.2, 20}, {14, 5, 21}, {3, 12, 20.5}};

TEST(ComplianceByBlocks, gives_the_forces_and_displacements_of_the_dense_one_within_its_accuracy) {
    const DeformableBody dense = sample::true_elastic_cube(5);
    HapticModel exact(holding(dense));
    TickResult exact_result{}, result{};
    for (const double accuracy : {1e-3, 1e-4}) {
        // Each entry is wrong by up to `accuracy` times the largest one, as often up as down, so that sums of
        // several are wrong by less than that.
        const double tolerance = accuracy;
        const DeformableBody body = by_scattered_blocks(dense, accuracy);
        HapticModel model(holding(body));
        double largest_difference = 0;
        for (const Vector3d& press : presses) {
            for (auto [m, r] : {std::pair(&exact, &exact_result), std::pair(&model, &result)}) {
                m->reset();
                go(*m, *r, press + Vector3d(0, 0, 5));
                go(*m, *r, press);
            }
            ASSERT_GT(result.contact_count, 0);
            const double difference = (force_of(result) - force_of(exact_result)).norm();
            EXPECT_LE(difference, tolerance * force_of(exact_result).norm()) << press.transpose();
            largest_difference = std::max(largest_difference, difference);
            const std::vector<Vector3f> u = displacements(model, result, body),
                                        v = displacements(exact, exact_result, dense);
            float largest = 0;
            for (const Vector3f& moved : v) largest = std::max(largest, moved.norm());
            for (std::size_t i = 0; i < u.size(); ++i)
                EXPECT_LE((u[i] - v[i]).norm(), static_cast<float>(tolerance) * largest) << "vertex " << i;
        }
        EXPECT_GT(largest_difference, 0);  // blocks of low rank took part
    }
}

TEST(ComplianceByBlocks, neither_ticks_nor_displacements_allocate) {
    const DeformableBody body = by_scattered_blocks(sample::true_elastic_cube(5), 1e-4);
    const auto model = std::make_unique<HapticModel>(holding(body));
    TickResult result{};
    std::vector<Vector3f> u(body.boundary.nodes.size());
    go(*model, result, {10, 10, 40});
    int touching = 0;
    std::size_t allocated = 0;
    {
        const AllocationTrap trap;
        for (int tick = 0; tick < samples_of(20000); ++tick) {
            const double t = 1e-3 * tick;
            go(*model, result,
               {10 + 9 * std::sin(1.1 * t), 10 + 9 * std::sin(2.3 * t), 22 + 2 * std::cos(5.1 * t)});
            model->surface_displacement(0, result, u);
            touching += result.contact_count > 0;
        }
        allocated = trap.count();
    }
    EXPECT_EQ(allocated, 0U);
    EXPECT_GT(touching, samples_of(5000));
}

// Every third node that could be one is no contact node, so that contact nodes and vertices are numbered
// differently all over the surface.
class SurfaceWithGaps : public ::testing::TestWithParam<bool> {
  protected:
    SurfaceWithGaps() {
        const DeformableBody whole = sample::true_elastic_cube(5);
        std::vector<std::int32_t> part = whole.contact_nodes;
        std::erase_if(part, [](std::int32_t node) { return node % 3 == 1; });
        body_ = sample::with_contact_nodes(whole, part);
        if (GetParam()) body_ = by_scattered_blocks(body_, 1e-6);
    }
    DeformableBody body_;
};

INSTANTIATE_TEST_SUITE_P(Each, SurfaceWithGaps, ::testing::Bool(),
                         [](const auto& info) { return info.param ? "hierarchical" : "dense"; });

TEST_P(SurfaceWithGaps, moves_each_vertex_as_its_contact_node_and_no_other) {
    HapticModel model(holding(body_));
    const LoadSpread spread(body_, compliance_blocks(body_));
    TickResult result{};
    const auto contact_node = [&](std::int32_t vertex) {
        const std::int32_t node = body_.boundary.nodes[static_cast<std::size_t>(vertex)];
        const auto found = std::ranges::lower_bound(body_.contact_nodes, node);
        return found != body_.contact_nodes.end() && *found == node
                   ? static_cast<std::int32_t>(found - body_.contact_nodes.begin())
                   : -1;
    };
    for (const Vector3d& press : presses) {
        model.reset();
        go(model, result, press + Vector3d(0, 0, 5));
        go(model, result, press);
        const std::vector<Vector3f> u = displacements(model, result, body_);
        float largest = 0;
        int left_out = 0;
        for (std::size_t v = 0; v < u.size(); ++v) {
            const std::int32_t own = contact_node(static_cast<std::int32_t>(v));
            Vector3f expected = Vector3f::Zero();
            for (const Contact& contact : result.active_contacts())
                for (std::size_t i = 0; i < 3 && own >= 0; ++i)
                    for (const LoadSpread::Share& share : spread.shares(contact.vertices[i]))
                        expected -= contact.weights[i] * share.weight * contact.force *
                                    (compliance_block(body_.compliance, own, contact_node(share.vertex)) *
                                     Eigen::Map<const Vector3f>(contact.normal.data()));
            if (own < 0) {
                EXPECT_EQ(u[v], Vector3f::Zero()) << "vertex " << v;
                ++left_out;
            }
            EXPECT_LE((u[v] - expected).norm(), 1e-5F) << "vertex " << v;  // float32 sums of a few mm
            largest = std::max(largest, u[v].norm());
        }
        EXPECT_GT(largest, 0.3F);
        EXPECT_GT(left_out, 36);  // more than those that are fixed
    }
}

}  // namespace
}  // namespace palpate
