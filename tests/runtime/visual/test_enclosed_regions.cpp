// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Cholesky>
#include <chrono>
#include <gtest/gtest.h>
#include <thread>
#include <vtkActorCollection.h>
#include <vtkMapper.h>
#include <vtkNew.h>
#include <vtkPolyData.h>

#include "formats/model/regions.hpp"
#include "runtime/visual/bodies/enclosed_regions.hpp"
#include "tests/runtime/elastic_cube.hpp"

namespace palpate {
namespace {

using Eigen::Vector3d;
using Eigen::Vector3f;

constexpr double rounding = 1e-5;  // mm, of places of 20 mm in float

// The elastic cube, [0, 20] mm, held below, with a tumour in its middle.
class EnclosedRegions : public ::testing::Test {
  protected:
    // By the whole stiffness: displacements of all nodes where `force` (N) acts on a node of the top.
    Eigen::VectorXd displaced_by(const Vector3d& force) const {
        const Eigen::MatrixXd all = sample::dense_stiffness(body_.mesh, sample::soft_tissue());
        std::vector<Eigen::Index> free;
        std::size_t held = 0;
        for (std::int32_t node = 0; node < std::ssize(body_.mesh.rest_positions); ++node)
            if (held < body_.fixed_nodes.size() && body_.fixed_nodes[held] == node)
                ++held;
            else
                for (Eigen::Index axis = 0; axis < 3; ++axis) free.push_back(3 * Eigen::Index{node} + axis);
        Eigen::VectorXd forces = Eigen::VectorXd::Zero(all.rows()), u = forces;
        forces.segment<3>(3 * Eigen::Index{body_.contact_nodes.back()}) = force;
        const Eigen::MatrixXd stiffness = all(free, free);
        const Eigen::VectorXd loads = forces(free), moved = stiffness.llt().solve(loads);
        u(free) = moved;
        return u;
    }

    std::vector<Vector3f> of_nodes(const Eigen::VectorXd& u, const std::vector<std::int32_t>& nodes) const {
        std::vector<Vector3f> of;
        for (const std::int32_t node : nodes)
            of.push_back(u.segment<3>(3 * Eigen::Index{node}).cast<float>());
        return of;
    }

    // The largest distance of a drawn vertex of the tumour from rest and `displacements`, mm.
    double off_by(vtkRenderer* renderer, const std::vector<Vector3f>& displacements) const {
        auto* const data =
            vtkPolyData::SafeDownCast(renderer->GetActors()->GetLastActor()->GetMapper()->GetInput());
        double largest = 0;
        for (std::size_t v = 0; v < displacements.size(); ++v)
            largest = std::max(largest, (Vector3d(data->GetPoint(static_cast<vtkIdType>(v))) -
                                         outline_.surface.vertices[v] - displacements[v].cast<double>())
                                            .norm());
        return largest;
    }

    // Frame after frame, until nothing is off or long after it should be.
    double off_by_after_following(visual::EnclosedRegions& regions, const std::vector<Vector3f>& surface,
                                  vtkRenderer* renderer, const std::vector<Vector3f>& expected) const {
        const auto deadline = std::chrono::steady_clock::now() + std::chrono::seconds(60);
        while (off_by(renderer, expected) > rounding && std::chrono::steady_clock::now() < deadline) {
            regions.follow(surface);
            std::this_thread::sleep_for(std::chrono::milliseconds(5));
        }
        return off_by(renderer, expected);
    }

    DeformableBody body_ = sample::true_elastic_cube(5);
    BoundarySurface outline_ = surface_of_region(body_.mesh, enclosed_regions(body_.mesh).front().value);
};

TEST_F(EnclosedRegions, go_with_the_tissue_around_them_once_it_is_known_how) {
    const Eigen::VectorXd u = displaced_by({0.1, 0, -0.3});
    const auto surface = of_nodes(u, body_.boundary.nodes), expected = of_nodes(u, outline_.nodes);
    ASSERT_FALSE(expected.empty());
    vtkNew<vtkRenderer> renderer;
    visual::EnclosedRegions regions(body_, Vector3d::UnitZ(), 0, renderer);
    ASSERT_EQ(regions.names(std::nullopt), std::vector<std::string>{"tumour"});
    ASSERT_GT(off_by(renderer, expected), 0.1);  // at rest

    regions.follow(surface);
    EXPECT_LT(off_by(renderer, std::vector<Vector3f>(expected.size(), Vector3f::Zero())), rounding)
        << "hidden";
    regions.show(true);
    EXPECT_LT(off_by_after_following(regions, surface, renderer, expected), rounding);
    const std::vector<Vector3f> rest(expected.size(), Vector3f::Zero());
    EXPECT_LT(off_by_after_following(regions, std::vector<Vector3f>(surface.size(), Vector3f::Zero()),
                                     renderer, rest),
              rounding);
}

}  // namespace
}  // namespace palpate
