// SPDX-License-Identifier: GPL-3.0-or-later
// Legacy VTK images as VTK's own writer, ParaView and ITK leave them.
#include <gtest/gtest.h>
#include <numeric>
#include <vtkBitArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkLookupTable.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkShortArray.h>
#include <vtkStringArray.h>
#include <vtkStructuredPoints.h>
#include <vtkStructuredPointsWriter.h>
#include <vtkUnsignedCharArray.h>

#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/hand_written_images.hpp"
#include "tests/tools/imaging/refusals.hpp"

namespace palpate::imaging {
namespace {

using sample::Scratch;
using test::volume_refusal;
using test::write_bytes;

/// 2 x 3 x 2 points with the values 0 ... 11, and what tests add, written by VTK.
template <typename Array = vtkShortArray>
class VtkWritten {
  public:
    VtkWritten() {
        data->SetDimensions(2, 3, 2);
        data->SetOrigin(1, 2, 3);
        data->SetSpacing(0.5, 0.75, 1.25);
        values->SetName("s");
        for (int n = 0; n < 12; ++n) values->InsertNextValue(static_cast<typename Array::ValueType>(n));
        data->GetPointData()->SetScalars(values);
    }

    void add_text(const char* name, const std::string& text) {
        vtkNew<vtkStringArray> array;
        array->SetName(name);
        array->InsertNextValue(text);
        data->GetFieldData()->AddArray(array);
    }

    std::filesystem::path write(const Scratch& folder, int kind) const {
        vtkNew<vtkStructuredPointsWriter> writer;
        writer->SetInputData(data);
        writer->SetFileType(kind);
        writer->SetFileName((folder / "v.vtk").c_str());
        EXPECT_EQ(writer->Write(), 1);
        return folder / "v.vtk";
    }

    vtkNew<vtkStructuredPoints> data;
    vtkNew<Array> values;
};

void expect_values(const Volume& volume) {
    std::vector<float> expected(12);
    std::iota(expected.begin(), expected.end(), 0.0F);
    EXPECT_EQ(volume.values, expected);
}

TEST(LegacyVtk, the_space_that_a_file_of_either_kind_states_is_honoured) {
    const Scratch folder;
    for (const int kind : {VTK_ASCII, VTK_BINARY}) {
        VtkWritten ras, lps;
        ras.add_text("Comment", std::string(300, 'x'));  // whose length takes two bytes
        ras.add_text("SPACE", "RAS");
        lps.add_text("SPACE", "LPS");
        const Volume turned = read_volume(ras.write(folder, kind)),
                     as_is = read_volume(lps.write(folder, kind));
        EXPECT_EQ(turned.grid.origin, Eigen::Vector3d(-1, -2, 3)) << kind;
        EXPECT_EQ(turned.grid.direction, Eigen::Matrix3d(Eigen::Vector3d(-1, -1, 1).asDiagonal())) << kind;
        EXPECT_EQ(as_is.grid.origin, Eigen::Vector3d(1, 2, 3)) << kind;
        expect_values(turned);
        for (const char* unknown : {"LAS", "RASP", ""}) {
            VtkWritten other;
            other.add_text("SPACE", unknown);
            EXPECT_SAYS(volume_refusal(other.write(folder, kind)), "(expected LPS or RAS)");
        }
    }
}

TEST(LegacyVtk, arrays_and_sections_that_are_no_voxels_are_passed_over) {
    const Scratch folder;
    for (const int kind : {VTK_ASCII, VTK_BINARY}) {
        VtkWritten image;
        vtkNew<vtkDoubleArray> time, of_cells, vectors;
        time->SetName("TimeValue");
        time->InsertNextValue(0.25);
        vtkNew<vtkBitArray> bits;
        bits->SetName("flags");
        for (int n = 0; n < 11; ++n) bits->InsertNextValue(n % 2);
        image.data->GetFieldData()->AddArray(time);
        image.data->GetFieldData()->AddArray(bits);
        image.add_text("SPACE", "RAS");
        time->SetComponentName(0, "t");  // METADATA between two arrays
        image.values->SetComponentName(0, "HU");
        of_cells->SetName("of cells");
        for (int n = 0; n < 2; ++n) of_cells->InsertNextValue(n);
        image.data->GetCellData()->SetScalars(of_cells);
        vectors->SetName("v");
        vectors->SetNumberOfComponents(3);
        for (int n = 0; n < 2; ++n) vectors->InsertNextTuple3(n, n, n);
        image.data->GetCellData()->SetVectors(vectors);
        vtkNew<vtkLookupTable> colours;
        colours->SetNumberOfTableValues(7);
        colours->Build();
        image.values->SetLookupTable(colours);
        const auto path = image.write(folder, kind);
        expect_values(read_volume(path));
        EXPECT_EQ(read_volume(path).grid.origin, Eigen::Vector3d(-1, -2, 3));
        write_bytes(path, test::bytes_of(path) +
                              "CELL_DATA 2\nSCALARS c unsigned_char\nLOOKUP_TABLE default\n" +
                              (kind == VTK_ASCII ? "7 8\n" : "xx\n"));
        expect_values(read_volume(path));
    }
}

TEST(LegacyVtk, one_array_of_a_field_at_the_points_is_taken_and_two_are_refused) {
    const Scratch folder;
    for (const int kind : {VTK_ASCII, VTK_BINARY}) {
        VtkWritten image;
        image.data->GetPointData()->SetActiveScalars(nullptr);  // so that it is written as a field
        const auto path = image.write(folder, kind);
        EXPECT_SAYS(test::bytes_of(path), "FIELD");
        expect_values(read_volume(path));
        vtkNew<vtkDoubleArray> more;
        more->SetName("more");
        more->SetNumberOfTuples(12);
        more->Fill(1);
        image.data->GetPointData()->AddArray(more);
        EXPECT_SAYS(volume_refusal(image.write(folder, kind)), "has 2 arrays at its points");
    }
}

TEST(LegacyVtk, unsigned_char_which_vtk_writes_as_colours_is_read) {
    const Scratch folder;
    for (const int kind : {VTK_ASCII, VTK_BINARY}) {
        const VtkWritten<vtkUnsignedCharArray> image;
        const auto path = image.write(folder, kind);
        EXPECT_SAYS(test::bytes_of(path), "COLOR_SCALARS");
        expect_values(read_volume(path));
    }
}

TEST(LegacyVtk, extents_move_the_origin) {
    const Scratch folder;
    VtkWritten image;
    const auto path = image.write(folder, VTK_ASCII);
    std::string text = test::bytes_of(path);
    text.replace(text.find("DIMENSIONS 2 3 2"), 16, "EXTENT 2 3 0 2 4 5");
    write_bytes(path, text);
    const Volume volume = read_volume(path);
    EXPECT_EQ(volume.grid.origin, Eigen::Vector3d(2, 2, 8));
    expect_values(volume);
}

TEST(LegacyVtk, false_claims_are_refused) {
    const Scratch folder;
    const std::string head = "# vtk DataFile Version 5.1\nx\nBINARY\nDATASET STRUCTURED_POINTS\n";
    const std::string size = "DIMENSIONS 2 3 2\n";
    for (const std::string& text :
         {head + "FIELD f 1\na 1 1 string\n" + std::string(8, '\x3f'),
          head + "FIELD f 1\na 4000000000 4000000000 double\n", head + "FIELD f 1\na 3 -1 int\n",
          head + "FIELD f 999999999\na 0 0 int\n", head + "FIELD f 1\nSPACE 1 1 string\n\xC3RA",
          head + size + "POINT_DATA 999999999\nSCALARS s short\nLOOKUP_TABLE default\n",
          head + size + "POINT_DATA 12\nSCALARS s short\nLOOKUP_TABLE default\n",
          head + size + "CELL_DATA 999999999\nVECTORS v double\n", head + size + "METADATA\nx",
          head + size + "LOOKUP_TABLE t 3\n"}) {
        write_bytes(folder / "v.vtk", text);
        EXPECT_SAYS(volume_refusal(folder / "v.vtk"), "v.vtk");
    }
}

}  // namespace
}  // namespace palpate::imaging
