// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <vtkCell.h>
#include <vtkCellData.h>
#include <vtkDataArray.h>
#include <vtkFieldData.h>
#include <vtkHDFReader.h>
#include <vtkNew.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>

#include "formats/asset/asset.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

class VtkReader : public ::testing::Test {
  protected:
    VtkReader() {
        const auto path = scratch_ / "case.vtkhdf";
        asset::write_asset(path, patient_case_);
        reader_->SetFileName(path.c_str());
        reader_->Update();
        grid_ = vtkUnstructuredGrid::SafeDownCast(reader_->GetOutputDataObject(0));
    }

    sample::Scratch scratch_;
    Case patient_case_ = sample::sample_case(4);
    const TriangleMesh& sphere_ = patient_case_.rigid_bodies[0].surface;
    const TetMesh& mesh_ = patient_case_.deformable_bodies[0].mesh;
    vtkNew<vtkHDFReader> reader_;
    vtkUnstructuredGrid* grid_ = nullptr;
};

TEST_F(VtkReader, sees_triangles_of_rigid_and_tetrahedra_of_deformable_bodies) {
    ASSERT_NE(grid_, nullptr);
    ASSERT_EQ(static_cast<std::size_t>(grid_->GetNumberOfCells()),
              sphere_.triangles.size() + mesh_.tetrahedra.size());
    EXPECT_EQ(grid_->GetCellType(0), 5);
    const auto first = static_cast<vtkIdType>(sphere_.triangles.size());
    const auto base = static_cast<vtkIdType>(sphere_.vertices.size());
    for (std::size_t t = 0; t < mesh_.tetrahedra.size(); ++t) {
        vtkCell* cell = grid_->GetCell(first + static_cast<vtkIdType>(t));
        ASSERT_EQ(cell->GetCellType(), 10);
        for (int corner = 0; corner < 4; ++corner)
            ASSERT_EQ(cell->GetPointId(corner), base + mesh_.tetrahedra[t][static_cast<std::size_t>(corner)]);
    }
    for (std::size_t node = 0; node < mesh_.rest_positions.size(); ++node) {
        const Eigen::Map<const Eigen::Vector3d> p(grid_->GetPoint(base + static_cast<vtkIdType>(node)));
        ASSERT_LT((p - mesh_.rest_positions[node]).norm(), 1e-5);  // mm: float32
    }
}

TEST_F(VtkReader, sees_regions_and_bodies_as_cell_data) {
    ASSERT_NE(grid_, nullptr);
    vtkDataArray* region = grid_->GetCellData()->GetArray("region");
    vtkDataArray* body = grid_->GetCellData()->GetArray("body");
    ASSERT_NE(region, nullptr);
    ASSERT_NE(body, nullptr);
    EXPECT_EQ(region->GetTuple1(0), 0);
    EXPECT_EQ(body->GetTuple1(0), 0);
    const auto first = static_cast<vtkIdType>(sphere_.triangles.size());
    for (std::size_t t = 0; t < mesh_.tetrahedra.size(); ++t) {
        ASSERT_EQ(region->GetTuple1(first + static_cast<vtkIdType>(t)), mesh_.regions[t]);
        ASSERT_EQ(body->GetTuple1(first + static_cast<vtkIdType>(t)), 1);
    }
}

TEST_F(VtkReader, sees_frame_and_names_as_field_data) {
    ASSERT_NE(grid_, nullptr);
    const auto text = [&](const char* name, vtkIdType i) -> std::string {
        auto* array = vtkStringArray::SafeDownCast(grid_->GetFieldData()->GetAbstractArray(name));
        return array && i < array->GetNumberOfValues() ? array->GetValue(i) : "";
    };
    EXPECT_EQ(text("SPACE", 0), "LPS");
    EXPECT_EQ(text("body_names", 0), "skull");
    EXPECT_EQ(text("body_names", 1), "wall");
    EXPECT_EQ(text("region_names", 0), "tissue");
    EXPECT_EQ(text("region_names", 1), "tumour");
}

}  // namespace
}  // namespace palpate
