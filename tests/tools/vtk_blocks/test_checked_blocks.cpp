// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>
#include <vtkCallbackCommand.h>
#include <vtkExecutive.h>
#include <vtkFieldData.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPolyData.h>
#include <vtkSmartPointer.h>
#include <vtkStringArray.h>
#include <vtkXMLPolyDataReader.h>

#include "tests/formats/scratch.hpp"
#include "tools/vtk_blocks/checked_blocks.hpp"

namespace palpate::vtk_blocks {
namespace {

// Whether the types are known of a file whose element `outer` has one element `inner` of a type.
bool knows(const char* outer, const char* inner, const char* type) {
    vtkNew<vtkXMLDataElement> file, around, array;
    file->SetName("VTKFile");
    around->SetName(outer);
    array->SetName(inner);
    if (type != nullptr) array->SetAttribute("type", type);
    around->AddNestedElement(array);
    file->AddNestedElement(around);
    return knows_types(*file);
}

// What a reader makes of a surface of one point whose field data have an array of texts "a" and "b".
class Texts : public testing::Test {
  protected:
    bool reads(const std::string& attributes, const std::string& data, const std::string& appended = "") {
        std::ofstream(folder_ / "texts.vtp")
            << R"(<VTKFile type="PolyData" byte_order="LittleEndian" header_type="UInt32"><PolyData><FieldData>)"
            << R"(<Array type="String" Name="names" )" << attributes << ">" << data
            << R"(</Array></FieldData><Piece NumberOfPoints="1" NumberOfVerts="0" NumberOfLines="0" )"
            << R"(NumberOfStrips="0" NumberOfPolys="0"><PointData><Array type="String" Name="of a point" )"
            << R"(format="ascii">97 0 98 0 99 0</Array></PointData><Points><DataArray type="Float32" )"
            << R"(NumberOfComponents="3" format="ascii">0 0 0</DataArray></Points></Piece></PolyData>)"
            << appended << "</VTKFile>";
        reader_ = vtkSmartPointer<WithCheckedBlocks<vtkXMLPolyDataReader>>::New();
        vtkNew<vtkCallbackCommand> complaint;
        complaint->SetClientData(&complained_);
        complaint->SetCallback(
            [](vtkObject*, unsigned long, void* flag, void*) { *static_cast<bool*>(flag) = true; });
        complained_ = false;
        for (vtkObject* object :
             {static_cast<vtkObject*>(reader_), static_cast<vtkObject*>(reader_->GetExecutive())})
            for (const auto event : {vtkCommand::ErrorEvent, vtkCommand::WarningEvent})
                object->AddObserver(event, complaint);
        reader_->SetFileName((folder_ / "texts.vtp").c_str());
        reader_->set_room(1 << 20);
        reader_->Update();
        return !complained_;
    }

    vtkStringArray* texts() {
        return vtkStringArray::SafeDownCast(reader_->GetOutput()->GetFieldData()->GetAbstractArray("names"));
    }

    sample::Scratch folder_;
    vtkSmartPointer<WithCheckedBlocks<vtkXMLPolyDataReader>> reader_;
    bool complained_ = false;
};

TEST_F(Texts, are_no_more_than_an_array_announces) {
    const std::string appended =
        std::string("<AppendedData encoding=\"raw\">_\4\0\0\0a\0b\0", 38) + "</AppendedData>";
    ASSERT_TRUE(reads(R"(NumberOfTuples="2" format="ascii")", "97 0 98 0"));
    ASSERT_NE(texts(), nullptr);
    EXPECT_EQ(texts()->GetValue(1), "b");
    EXPECT_TRUE(reads(R"(NumberOfTuples="2" format="appended" offset="0")", "", appended));
    EXPECT_EQ(texts()->GetValue(1), "b");
    EXPECT_FALSE(reads(R"(NumberOfTuples="1" format="ascii")", "97 0 98 0"));
    EXPECT_FALSE(reads(R"(NumberOfTuples="1" format="appended" offset="0")", "", appended));
    EXPECT_FALSE(reads(R"(NumberOfTuples="1" format="appended" offset="x")", "", appended));
    EXPECT_FALSE(reads(R"(NumberOfTuples="x" format="ascii")", "97 0 98 0"));
}

TEST_F(Texts, of_points_are_left_out) {
    ASSERT_TRUE(reads(R"(NumberOfTuples="2" format="ascii")", "97 0 98 0"));
    EXPECT_EQ(reader_->GetOutput()->GetPointData()->GetNumberOfArrays(), 0);
}

TEST(CheckedBlocks, arrays_are_of_the_types_that_vtk_writes) {
    for (const char* type : {"Int8", "UInt8", "Int16", "UInt16", "Int32", "UInt32", "Int64", "UInt64",
                             "Float32", "Float64", "String", "Bit"})
        EXPECT_TRUE(knows("PointData", "DataArray", type)) << type;
    for (const char* type : {"Float31", "", static_cast<const char*>(nullptr)})
        for (const char* name : {"DataArray", "Array"}) EXPECT_FALSE(knows("PointData", name, type)) << name;
}

TEST(CheckedBlocks, all_of_a_field_data_is_taken_for_arrays) {
    EXPECT_FALSE(knows("FieldData", "Note", nullptr));
    EXPECT_TRUE(knows("FieldData", "Note", "Int8"));
    EXPECT_TRUE(knows("Piece", "Note", nullptr));
}

}  // namespace
}  // namespace palpate::vtk_blocks
