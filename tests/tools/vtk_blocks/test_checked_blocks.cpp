// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>
#include <vtkNew.h>

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
