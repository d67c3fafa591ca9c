// SPDX-License-Identifier: Apache-2.0
#include <cmath>
#include <gtest/gtest.h>
#include <vector>
#include <vtkActor.h>
#include <vtkActorCollection.h>
#include <vtkDataArray.h>
#include <vtkMapper.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkRenderer.h>

#include "formats/model/arrays.hpp"
#include "formats/model/contact/compliance_blocks.hpp"
#include "formats/model/contact/load_shares.hpp"
#include "runtime/session/drawn_shape.hpp"
#include "runtime/visual/actors.hpp"
#include "runtime/visual/bodies/soft_surface.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/runtime/elastic_cube.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

// The true elastic cube, [0, 20] mm, held below, under a rough tool.
class DisplayedSurface : public ::testing::Test {
  protected:
    static Case cube(DeformableBody body) {
        Case c;
        c.name = "cube";
        c.deformable_bodies.push_back(std::move(body));
        c.haptics = {.tool_radius = 3,
                     .coupling_stiffness = 0.5,
                     .max_force = 99,
                     .max_force_rate = 99,
                     .friction_at_rest = 0.4,
                     .friction_sliding = 0.3};
        return c;
    }

    // rest + C_sc f of what the tick reports, by C's own entries in double: every contact's force and
    // friction goes to the vertices around it as contact spreads it, and from there through whole columns.
    std::vector<Vector3d> expected(const TickResult& tick) const {
        const std::vector<std::int32_t> blocks = compliance_blocks(dense_);
        const LoadShares shares = load_shares(dense_, blocks, spread_disc(dense_, blocks).reach);
        const auto& c = std::get<DenseCompliance>(dense_.compliance);
        Eigen::VectorXd force = Eigen::VectorXd::Zero(static_cast<Eigen::Index>(c.dof_count()));
        for (const Contact& contact : tick.active_contacts())
            for (std::size_t i = 0; i < 3 && contact.vertices[i] >= 0; ++i)
                for (const LoadShare& share : shares.of(contact.vertices[i]))
                    if (blocks[share.vertex] >= 0)
                        force.segment<3>(3 * blocks[share.vertex]) -=
                            static_cast<double>(contact.weights[i] * share.weight) * reaction_of(contact);
        const Eigen::VectorXd u = Eigen::Map<const Eigen::Matrix<float, -1, -1, Eigen::RowMajor>>(
                                      c.row(0), force.size(), force.size())
                                      .cast<double>() *
                                  force;
        std::vector<Vector3d> positions = dense_.boundary.surface.vertices;
        for (std::size_t v = 0; v < positions.size(); ++v)
            if (blocks[v] >= 0) positions[v] += u.segment<3>(3 * blocks[v]);
        return positions;
    }

    std::vector<Vector3f> normals_of(const std::vector<Vector3d>& positions) const {
        std::vector<Vector3f> drawn, normals(positions.size());
        for (const Vector3d& p : positions) drawn.push_back(p.cast<float>());
        visual::vertex_normals(drawn, dense_.boundary.surface.triangles, normals);
        return normals;
    }

    // Leads a tool over and into the body; at each frame of 16 ticks, compares what is displayed.
    void press_and_compare(const DeformableBody& body, double tolerance) {
        const Case patient_case = cube(body);
        haptics::HapticModel model(patient_case);
        session::DrawnShape shape(patient_case);
        std::vector<std::vector<Vector3f>> displacements{
            std::vector<Vector3f>(body.boundary.nodes.size(), Vector3f::Constant(9))};  // which must go
        vtkNew<vtkRenderer> renderer;
        const visual::StiffnessMap map(patient_case, renderer);
        visual::SoftSurface surface(patient_case.deformable_bodies[0], Vector3d::UnitZ(), 1, map, renderer);
        auto* const data =
            vtkPolyData::SafeDownCast(renderer->GetActors()->GetLastActor()->GetMapper()->GetInput());
        ASSERT_EQ(data->GetNumberOfPoints(), static_cast<vtkIdType>(body.boundary.nodes.size()));

        const std::vector<Vector3f> at_rest = normals_of(body.boundary.surface.vertices);
        realtime::DeviceState state{};
        TickResult tick{};
        double deepest = 0, largest_error = 0, turned = 0, largest_turn = 0;
        int several = 0;
        for (int i = 0; i < 1600; ++i) {
            const double t = 1e-3 * i;
            state.time = t;
            state.position = {10 + 8 * std::sin(2.1 * t), 10 + 8 * std::sin(3.3 * t),
                              23 + 3 * std::cos(5 * t)};
            model.tick(state, tick);
            if (i % 16 != 0) continue;
            const TickResult* ticks = &tick;
            shape.follow(model, tick.time, {&ticks, 1}, displacements);
            surface.deform(displacements[0]);
            const std::vector<Vector3d> positions = expected(tick);
            several += tick.contact_count > 1;
            for (std::size_t v = 0; v < positions.size(); ++v) {
                const Vector3d drawn(data->GetPoint(static_cast<vtkIdType>(v)));
                deepest = std::max(deepest, (positions[v] - body.boundary.surface.vertices[v]).norm());
                largest_error = std::max(largest_error, (drawn - positions[v]).norm());
            }
            const std::vector<Vector3f> normals = normals_of(positions);
            for (std::size_t v = 0; v < positions.size(); ++v) {
                const Vector3d drawn(
                    data->GetPointData()->GetNormals()->GetTuple3(static_cast<vtkIdType>(v)));
                turned = std::max(turned, (drawn - at_rest[v].cast<double>()).norm());
                largest_turn = std::max(largest_turn, (drawn - normals[v].cast<double>()).norm());
            }
        }
        EXPECT_GT(several, 2);
        EXPECT_GT(deepest, 1);  // mm
        EXPECT_LT(largest_error, tolerance * deepest);
        EXPECT_GT(turned, 0.1) << "shading follows";
        EXPECT_LT(largest_turn, std::max(100 * tolerance, 1e-3) * turned);
    }

    const DeformableBody dense_ = sample::true_elastic_cube(5);
};

// Positions are drawn in float32: of 20 mm, that is 1e-6 mm.
TEST_F(DisplayedSurface, is_the_compliance_times_the_reported_forces_vertex_by_vertex) {
    press_and_compare(dense_, 1e-5);
}

// Each entry is wrong by up to the accuracy times the largest one; sums of several by less.
TEST_F(DisplayedSurface, of_a_compliance_by_blocks_is_so_within_its_accuracy) {
    for (const double accuracy : {1e-3, 1e-4})
        press_and_compare(sample::with_hierarchical_compliance(dense_, 3, accuracy), accuracy);
}

}  // namespace
}  // namespace palpate
