// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>
#include <vtkBitArray.h>
#include <vtkCellData.h>
#include <vtkDoubleArray.h>
#include <vtkFieldData.h>
#include <vtkFloatArray.h>
#include <vtkIntArray.h>
#include <vtkNew.h>
#include <vtkPointData.h>
#include <vtkPoints.h>
#include <vtkStringArray.h>
#include <vtkUnstructuredGrid.h>
#include <vtkUnstructuredGridWriter.h>
#include <vtkXMLUnstructuredGridWriter.h>

#include "tests/tools/meshing/imported_files.hpp"
#include "tests/tools/real_data.hpp"
#include "tools/meshing/files/imported_mesh.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/meshing/measures/quality.hpp"

namespace palpate {
namespace {

using namespace meshing;

namespace fs = std::filesystem;

using test::bytes;

class ImportedMesh : public test::ImportedFiles {};

// As VTK writes it: ASCII and binary, of versions 4.2 and 5.1, under a title that sounds like values.
std::vector<fs::path> legacy_files_of(vtkUnstructuredGrid* grid, const fs::path& folder) {
    std::vector<fs::path> files;
    vtkNew<vtkUnstructuredGridWriter> writer;
    writer->SetInputData(grid);
    writer->SetHeader("scalars at step 100");
    for (const int kind : {VTK_ASCII, VTK_BINARY})
        for (const int version : {42, 51}) {
            files.push_back(folder / (std::to_string(kind) + std::to_string(version) + ".vtk"));
            writer->SetFileType(kind);
            writer->SetFileVersion(version);
            writer->SetFileName(files.back().c_str());
            EXPECT_EQ(writer->Write(), 1);
        }
    return files;
}

// Two tetrahedra that share a face, of groups 5 and 7; the second one is written inverted. Node 40 is unused.
const std::string nodes_1 = "$NOD\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n9 1 1 1\n40 8 8 8\n$ENDNOD\n";
const std::string gmsh_1 =
    nodes_1 + "$ELM\n3\n1 4 5 1 4 1 2 3 4\n2 4 7 2 4 2 3 9 4\n3 2 3 1 3 1 2 3\n$ENDELM\n";
const std::string gmsh_2 =
    "$MeshFormat\n2.2 0 8\n$EndMeshFormat\n$PhysicalNames\n3\n2 3 \"skin\"\n3 5 \"liver\"\n3 7 \"tumour of "
    "liver\"\n"
    "$EndPhysicalNames\n$Nodes\n6\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n9 1 1 1\n40 8 8 8\n$EndNodes\n"
    "$Elements\n3\n1 4 2 5 1 1 2 3 4\n2 4 3 7 2 0 2 3 9 4\n3 2 2 3 1 1 2 3\n$EndElements\n";
const std::string gmsh_4 =
    "$MeshFormat\n4.1 0 8\n$EndMeshFormat\n$PhysicalNames\n2\n3 5 \"liver\"\n3 7 \"tumour of liver\"\n"
    "$EndPhysicalNames\n$Entities\n1 0 1 2\n1 0 0 0 0\n1 0 0 0 1 1 0 1 3 0\n1 0 0 0 1 1 1 1 5 1 1\n"
    "2 0 0 0 1 1 1 1 7 0\n$EndEntities\n$Nodes\n2 6 1 40\n2 1 1 2\n1\n2\n0 0 0 0 0\n1 0 0 0 0\n"
    "3 1 0 4\n3\n4\n9\n40\n0 1 0\n0 0 1\n1 1 1\n8 8 8\n$EndNodes\n"
    "$Elements\n3 3 1 3\n3 1 4 1\n1 1 2 3 4\n3 2 4 1\n2 2 3 9 4\n2 1 2 1\n3 1 2 3\n$EndElements\n";
const std::string medit =
    "MeshVersionFormatted 2\n# by hand\nDimension\n3\nVertices\n6\n0 0 0 0\n1 0 0 0\n0 1 0 0\n0 0 1 0\n1 1 1 "
    "0\n"
    "8 8 8 0\nRidges\n1\n1\nTriangles\n1\n1 2 3 3\nTetrahedra\n2\n1 2 3 4 5\n2 3 5 4 7\nEnd\n";

// The same two tetrahedra, with the numbers behind CELLS and CELL_TYPES.
std::string legacy(const std::string& cells, const std::string& types) {
    return "# vtk DataFile Version 2.0\nx\nASCII\nDATASET UNSTRUCTURED_GRID\nPOINTS 5 double\n"
           "0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\nCELLS " +
           cells + "\n4 0 1 2 3\n4 1 2 4 3\nCELL_TYPES " + types + "\n10\n10\n";
}

std::string gmsh_2_binary() {
    std::string text = "$MeshFormat\n2.2 1 8\n" + bytes(1) + "\n$EndMeshFormat\n$Nodes\n5\n";
    const double nodes[5][3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}, {0, 0, 1}, {1, 1, 1}};
    for (int n = 0; n < 5; ++n) {
        text += bytes(n + 1);
        for (const double x : nodes[n]) text += bytes(x);
    }
    text += "\n$EndNodes\n$Elements\n2\n";
    for (const int word : {4, 2, 2, 1, 5, 1, 1, 2, 3, 4, 2, 7, 2, 2, 3, 5, 4}) text += bytes(word);
    return text + "\n$EndElements\n";
}

void expect_the_two_tetrahedra(const TetMesh& mesh) {
    ASSERT_EQ(mesh.tetrahedra.size(), 2U);
    EXPECT_EQ(mesh.rest_positions.size(), 5U);
    EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{5, 7}));
    EXPECT_DOUBLE_EQ(six_volume(mesh, 0), 1);
    EXPECT_DOUBLE_EQ(six_volume(mesh, 1), 2);
    EXPECT_EQ(measure(mesh).boundary.open_edges, 0);
    EXPECT_EQ(mesh.outside_labels, (std::vector<std::int32_t>{0, 0, 0, 0, 0}));
}

TEST_F(ImportedMesh, every_tetrahedral_format_gives_the_same_mesh) {
    for (const auto& [name, text] : {std::pair<std::string, std::string>{"1.msh", gmsh_1},
                                     {"2.msh", gmsh_2},
                                     {"2b.msh", gmsh_2_binary()},
                                     {"4.msh", gmsh_4},
                                     {"m.mesh", medit}}) {
        SCOPED_TRACE(name);
        expect_the_two_tetrahedra(tetrahedra(name, text));
        EXPECT_TRUE(noted("1 of 2 tetrahedra were inverted"));
    }
    EXPECT_TRUE(noted("1 unused nodes"));
    EXPECT_TRUE(noted("ignored 1 of kind 'triangle'"));
}

TEST_F(ImportedMesh, vtk_files_bring_regions_and_their_names) {
    const TetMesh mesh = tetrahedra("2.msh", gmsh_2);
    write_tetrahedra(folder_ / "a.vtu", mesh);
    const TetMesh again = read_imported_tetrahedra(folder_ / "a.vtu", {});
    expect_the_two_tetrahedra(again);
    EXPECT_EQ(again.region_names[1].name, "tumour of liver");
    expect_the_two_tetrahedra(tetrahedra("old.vtk",
                                         "# vtk DataFile Version 3.0\nx\nASCII\nDATASET "
                                         "UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n"
                                         "CELLS 3 14\n4 0 1 2 3\n3 0 1 2\n4 1 2 4 3\nCELL_TYPES "
                                         "3\n10\n5\n10\nCELL_DATA 3\nSCALARS gmsh:physical int 1\n"
                                         "LOOKUP_TABLE default\n5\n3\n7\n"));
}

TEST_F(ImportedMesh, names_of_physical_groups_name_regions_and_options_overrule_them) {
    EXPECT_EQ(tetrahedra("4.msh", gmsh_4).region_names[1].name, "tumour of liver");
    EXPECT_EQ(tetrahedra("1.msh", gmsh_1).region_names[0].name, "region 5");
    ImportedMeshOptions options;
    options.region_names = {{7, "lesion"}};
    EXPECT_EQ(tetrahedra("4.msh", gmsh_4, options).region_names[1].name, "lesion");
    options.region_names = {{8, "lesion"}};
    expect_refusal({"has no region 8", "5, 7"}, "4.msh", gmsh_4, options);
}

TEST_F(ImportedMesh, unit_and_frame_place_the_mesh) {
    ImportedMeshOptions options;
    options.unit = "cm";
    options.frame = "ras";
    const TetMesh mesh = tetrahedra("1.msh", gmsh_1, options);
    EXPECT_EQ(mesh.rest_positions[4], Eigen::Vector3d(-10, -10, 10));
    EXPECT_GT(six_volume(mesh, 0), 999);
    EXPECT_TRUE(noted("10 x 10 x 10 mm, read as cm in RAS"));
    options.unit = "parsec";
    expect_refusal({"parsec", "mm, cm"}, "1.msh", gmsh_1, options);
}

TEST_F(ImportedMesh, region_values_that_are_no_labels_get_the_lowest_free_one) {
    for (const std::string value : {"0", "-3", "65536", "70000"}) {
        std::string text = medit;
        text.replace(text.find("3 4 5\n"), 6, "3 4 " + value + "\n");
        const TetMesh mesh = tetrahedra("m.mesh", text);
        EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{1, 7}));
        EXPECT_EQ(mesh.region_names[0].name, "region " + value);
        EXPECT_TRUE(noted(("region " + value + " became 1").c_str()));
    }
}

TEST_F(ImportedMesh, region_values_of_more_than_32_bits_are_refused) {
    std::string text = medit;
    text.replace(text.find("3 4 5\n"), 6, "3 4 5000000000\n");
    expect_refusal({"reference 5000000000", "32 bits"}, "m.mesh", text);
    expect_refusal({"physical group 5000000000", "32 bits"}, "1.msh",
                   nodes_1 + "$ELM\n1\n1 4 5000000000 1 4 1 2 3 4\n$ENDELM\n");
    for (const std::string value : {"5000000000", "1.5"})
        expect_refusal({"array 'region'", "32 bits"}, "r.vtk",
                       legacy("2 10", "2") +
                           "CELL_DATA 2\nSCALARS region double 1\nLOOKUP_TABLE default\n1 " + value + "\n");
}

TEST_F(ImportedMesh, after_the_last_label_free_ones_below_are_taken) {
    LabelMap map;
    map.grid.size = {5, 5, 5};
    map.grid.origin = {-2, -2, -2};
    map.names = {{1, "kidney", {}}, {65535, "liver", {}}};
    map.labels.assign(125, 1);
    TetMesh mesh = tetrahedra("2.msh", gmsh_2);
    const TetMesh before = mesh;
    adopt_labels(mesh, map);
    EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{65535, 2}));
    map.names.resize(1);
    for (std::int32_t value = 2; value <= 65535; ++value)
        map.names.push_back({value, value == 2 ? "liver" : "other", {}});
    mesh = before;
    EXPECT_THROW(adopt_labels(mesh, map), InvalidInput);
}

TEST_F(ImportedMesh, repeated_sections_of_medit_are_refused) {
    const std::string open = medit.substr(0, medit.find("End"));
    expect_refusal({"a second section Vertices"}, "m.mesh", open + "Vertices\n1\n0 0 0 0\nEnd\n");
    expect_refusal({"a second section Tetrahedra"}, "m.mesh", open + "Tetrahedra\n1\n1 2 3 4 5\nEnd\n");
}

TEST_F(ImportedMesh, counts_of_legacy_vtk_files_that_contradict_each_other_are_refused) {
    EXPECT_EQ(tetrahedra("a.vtk", legacy("2 10", "2")).tetrahedra.size(), 2U);
    expect_refusal({"7 cells that do not fit into 10 numbers"}, "b.vtk", legacy("7 10", "2"));
    expect_refusal({"2 cells that do not fit into 0 numbers"}, "c.vtk", legacy("2 0", "2"));
    expect_refusal({"1 cells"}, "d.vtk", legacy("1 5", "2"));
    expect_refusal({"10 numbers, of which the cells use 5"}, "e.vtk", legacy("1 10", "1"));
    expect_refusal({"announces 999999999 entries"}, "f.vtk", legacy("2 10", "999999999"));
    for (const std::string corner : {"5", "-1", "4294967296"}) {
        std::string text = legacy("2 10", "2");
        text.replace(text.find("2 4 3\n"), 6, "2 4 " + corner + "\n");
        expect_refusal({("names point " + corner).c_str()}, "h.vtk", text);
    }
    expect_refusal({"a second section cells"}, "g.vtk", legacy("2 10", "2\n10 10\nCELLS 0 0\n"));
}

TEST_F(ImportedMesh, legacy_vtk_files_of_version_5_are_read_in_either_kind) {
    const TetMesh mesh = tetrahedra("a.vtk", legacy("2 10", "2"));
    vtkNew<vtkUnstructuredGrid> grid;
    vtkNew<vtkPoints> points;
    for (const Eigen::Vector3d& p : mesh.rest_positions) points->InsertNextPoint(p.data());
    grid->SetPoints(points);
    for (const Tetrahedron& t : mesh.tetrahedra) {
        const std::array<vtkIdType, 4> nodes{t[0], t[1], t[2], t[3]};
        grid->InsertNextCell(VTK_TETRA, 4, nodes.data());
    }
    for (const fs::path& path : legacy_files_of(grid, folder_))
        EXPECT_EQ(read_imported_tetrahedra(path, {}).tetrahedra, mesh.tetrahedra) << path;
}

TEST_F(ImportedMesh, legacy_vtk_fields_of_every_kind_are_passed_over_and_regions_kept) {
    const TetMesh mesh = tetrahedra("a.vtk", legacy("2 10", "2"));
    vtkNew<vtkUnstructuredGrid> grid;
    vtkNew<vtkPoints> points;
    for (const Eigen::Vector3d& p : mesh.rest_positions) points->InsertNextPoint(p.data());
    points->GetData()->SetComponentName(0, "x");  // METADATA, with two empty names
    grid->SetPoints(points);
    for (const Tetrahedron& t : mesh.tetrahedra) {
        const std::array<vtkIdType, 4> nodes{t[0], t[1], t[2], t[3]};
        grid->InsertNextCell(VTK_TETRA, 4, nodes.data());
    }
    vtkNew<vtkStringArray> space, names, long_ones;
    space->SetName("SPACE");
    space->InsertNextValue("RAS");
    names->SetName("region_names");
    names->InsertNextValue("liver");
    names->InsertNextValue("tumour of\nliver");
    vtkNew<vtkIntArray> values, region;
    values->SetName("region_values");
    values->InsertNextValue(5);
    values->InsertNextValue(7);
    values->SetComponentName(0, "cells");
    long_ones->SetName("log");
    for (const std::size_t length : {0, 100, 20000}) long_ones->InsertNextValue(std::string(length, 'l'));
    vtkNew<vtkBitArray> bits;
    bits->SetName("bits");
    for (int n = 0; n < 19; ++n) bits->InsertNextValue(n % 2);
    vtkNew<vtkDoubleArray> time;
    time->SetName("TimeValue");
    time->InsertNextValue(-0.5);
    for (vtkAbstractArray* array :
         std::initializer_list<vtkAbstractArray*>{time, values, names, bits, long_ones, space})
        grid->GetFieldData()->AddArray(array);
    region->SetName("region");
    region->InsertNextValue(5);
    region->InsertNextValue(7);
    grid->GetCellData()->AddArray(region);
    grid->GetCellData()->AddArray(names);  // binary texts of cells too
    vtkNew<vtkBitArray> flags;
    flags->SetName("flags");
    for (int n = 0; n < 5; ++n) flags->InsertNextValue(n % 2);
    grid->GetPointData()->AddArray(flags);  // the file ends with more values than bytes
    vtkNew<vtkFloatArray> field;
    field->SetName("field");
    field->SetNumberOfComponents(3);
    for (int n = 0; n < 5; ++n) field->InsertNextTuple3(-3, 100, 1e9);
    grid->GetPointData()->SetVectors(field);
    for (const fs::path& path : legacy_files_of(grid, folder_)) {
        const TetMesh read = read_imported_tetrahedra(path, {});
        EXPECT_EQ(read.tetrahedra, mesh.tetrahedra) << path;
        EXPECT_EQ(read.regions, (std::vector<std::int32_t>{5, 7}));
        EXPECT_EQ(read.region_names.at(0).name, "liver");
        EXPECT_EQ(read.rest_positions[1], Eigen::Vector3d(-1, 0, 0));
    }
}

TEST_F(ImportedMesh, values_after_a_lookup_table_of_scalars_are_no_number_of_colours) {
    const std::string mesh = legacy("2 10", "2");
    for (const char* scalars : {"POINT_DATA 5\nSCALARS s float\nLOOKUP_TABLE default\n-3 1e9 0 0 0\n",
                                "POINT_DATA 5\nSCALARS s float 1\nLOOKUP_TABLE t\n-3 1e9 0 0 0\n"
                                "LOOKUP_TABLE t 2\n0 0 0 1\n1 1 1 1\n",
                                "CELL_DATA 2\nNORMALS scalars float\n100 200 -3 1 1 1\n",
                                "FIELD f 2\nNULL_ARRAY\na 1 2 float\n-1 2\n"})
        EXPECT_EQ(tetrahedra("a.vtk", mesh + scalars).tetrahedra.size(), 2U) << scalars;
    for (const char* hostile :
         {"POINT_DATA 5\nSCALARS s float\nLOOKUP_TABLE t\n1 1 1 1 1\nLOOKUP_TABLE t 999999999\n",
          "POINT_DATA 5\nVECTORS SCALARS floats\nLOOKUP_TABLE t 999999999\n",
          "FIELD f 1\nSCALARS 1 0 float\nLOOKUP_TABLE t 999999999\n", "FIELD f 1\na 99999 99999 floats\n1\n",
          "POINT_DATA 5\nSCALARS s float 99999999\n"})
        expect_refusal({"than the file has room for"}, "b.vtk", mesh + hostile);
    std::string binary = "# vtk DataFile Version 3.0\nx\nBINARY\nDATASET UNSTRUCTURED_GRID\n";
    for (const char* texts :
         {"FIELD f 1\na 1 1 string\n\x3f       ", "CELL_DATA 0\nFIELD f 1\na 1 1 string\n\x7f   "})
        expect_refusal({"c.vtk"}, "c.vtk", binary + texts);
}

std::string vtu(const std::string& points, const std::string& cells, const std::string& components,
                const std::string& offsets) {
    return "<VTKFile type=\"UnstructuredGrid\" version=\"0.1\" byte_order=\"LittleEndian\"><UnstructuredGrid>"
           "<Piece NumberOfPoints=\"" +
           points + "\" NumberOfCells=\"" + cells +
           "\"><Points><DataArray type=\"Float64\" NumberOfComponents=\"" + components +
           "\" format=\"ascii\">0 0 0 10 0 0 0 10 0 0 0 10 10 10 10</DataArray></Points><Cells>"
           "<DataArray type=\"Int64\" Name=\"connectivity\" format=\"ascii\">0 1 2 3 1 2 3 4</DataArray>"
           "<DataArray type=\"Int64\" Name=\"offsets\" format=\"ascii\">" +
           offsets +
           "</DataArray><DataArray type=\"UInt8\" Name=\"types\" format=\"ascii\">10 10</DataArray></Cells>"
           "</Piece></UnstructuredGrid></VTKFile>";
}

TEST_F(ImportedMesh, counts_of_vtk_xml_files_that_cannot_be_are_refused) {
    EXPECT_EQ(tetrahedra("LIVER.VTU", vtu("5", "2", "3", "4 8")).tetrahedra.size(), 2U);
    EXPECT_EQ(tetrahedra("n.vtu", vtu("5", "2", "3\" Name=\"NumberOfBones", "4 8")).tetrahedra.size(), 2U);
    expect_refusal({"NumberOfCells is '999999999999'"}, "a.vtu", vtu("5", "999999999999", "3", "4 8"));
    expect_refusal({"NumberOfPoints is '-1'"}, "b.vtu", vtu("-1", "2", "3", "4 8"));
    expect_refusal({"NumberOfComponents is '0'"}, "c.vtu", vtu("5", "2", "0", "4 8"));
    expect_refusal({"NumberOfComponents is '99999999999999999999'"}, "d.vtu",
                   vtu("5", "2", "99999999999999999999", "4 8"));
    for (const char* offsets : {"4 9", "8 4", "-4 8", "4"})
        expect_refusal({"e.vtu"}, "e.vtu", vtu("5", "2", "3", offsets));
}

// The two tetrahedra by VTK's writer, in the kind of data that `set` chooses.
template <typename Set>
fs::path vtu_of_vtk(const fs::path& path, const TetMesh& mesh, Set set) {
    vtkNew<vtkUnstructuredGrid> grid;
    vtkNew<vtkPoints> points;
    for (const Eigen::Vector3d& p : mesh.rest_positions) points->InsertNextPoint(p.data());
    grid->SetPoints(points);
    for (const Tetrahedron& t : mesh.tetrahedra) {
        const std::array<vtkIdType, 4> nodes{t[0], t[1], t[2], t[3]};
        grid->InsertNextCell(VTK_TETRA, 4, nodes.data());
    }
    vtkNew<vtkStringArray> space, none;
    space->SetName("SPACE");
    space->InsertNextValue("LPS");
    none->SetName("none");
    grid->GetFieldData()->AddArray(space);
    grid->GetFieldData()->AddArray(none);
    vtkNew<vtkXMLUnstructuredGridWriter> writer;
    writer->SetInputData(grid);
    writer->SetFileName(path.c_str());
    set(*writer.Get());
    EXPECT_EQ(writer->Write(), 1);
    return path;
}

TEST_F(ImportedMesh, compressed_vtk_xml_files_of_every_kind_are_read) {
    const TetMesh mesh = tetrahedra("a.vtk", legacy("2 10", "2"));
    using Writer = vtkXMLWriter;
    for (const int mode : {int{Writer::Binary}, int{Writer::Appended}, int{Writer::Ascii}})
        for (const int compressor :
             {int{Writer::NONE}, int{Writer::ZLIB}, int{Writer::LZ4}, int{Writer::LZMA}})
            for (const int header : {int{Writer::UInt32}, int{Writer::UInt64}})
                for (const int order : {int{Writer::BigEndian}, int{Writer::LittleEndian}})
                    for (const bool encoded : {false, true})
                        for (const std::size_t block : {24, 32768}) {
                            const auto path = vtu_of_vtk(folder_ / "b.vtu", mesh, [&](auto& writer) {
                                writer.SetDataMode(mode);
                                writer.SetCompressorType(compressor);
                                writer.SetHeaderType(header);
                                writer.SetByteOrder(order);
                                writer.SetEncodeAppendedData(encoded);
                                writer.SetBlockSize(block);
                            });
                            EXPECT_EQ(read_imported_tetrahedra(path, {}).tetrahedra, mesh.tetrahedra)
                                << mode << compressor << header << order << encoded << block;
                        }
}

TEST_F(ImportedMesh, blocks_beyond_what_a_vtk_xml_file_has_room_for_are_refused) {
    const TetMesh mesh = tetrahedra("a.vtk", legacy("2 10", "2"));
    const auto path = vtu_of_vtk(folder_ / "b.vtu", mesh, [](auto& writer) {
        writer.SetHeaderType(vtkXMLWriter::UInt64);
        writer.EncodeAppendedDataOff();
    });
    std::ifstream stream(path, std::ios::binary);
    const std::string whole(std::istreambuf_iterator<char>(stream), {});
    // Of the text SPACE: number of blocks, their size, that of the last, its packed size.
    const std::size_t at = whole.find('_', whole.find("<AppendedData")) + 1;
    const std::int64_t much = std::int64_t{1} << 34;
    for (const auto& [word, value] : std::vector<std::pair<std::size_t, std::int64_t>>{
             {0, much}, {0, 1 << 20}, {0, -1}, {1, 0}, {2, much}, {2, -1}, {3, much}, {3, -1}}) {
        std::string text = whole;
        text.replace(at + 8 * word, 8, bytes(value));
        expect_refusal({"c.vtu", "is not a readable VTK"}, "c.vtu", text);
    }
}

TEST_F(ImportedMesh, medit_files_of_tetgen_that_announce_too_many_triangles_are_read) {
    std::string text = medit;
    text.replace(text.find("Triangles\n1\n"), 12, "Triangles\n9\n");
    text.insert(text.find("Tetrahedra"), "# Set of Tetrahedra\n");
    expect_the_two_tetrahedra(tetrahedra("t.mesh", text));
    EXPECT_TRUE(noted("ignored 1 of kind 'triangle'"));
}

TEST_F(ImportedMesh, other_solid_cells_are_refused_by_kind) {
    std::string text = gmsh_2;
    text.replace(text.find("3 2 2 3 1 1 2 3\n"), 16, "3 7 2 5 1 1 2 3 4 9\n");
    expect_refusal({"1 of kind 'pyramid'", "linear tetrahedra"}, "2.msh", text);
    text = gmsh_2;
    text.replace(text.find("3 2 2 3 1 1 2 3\n"), 16, "3 11 2 5 1 1 2 3 4 9 9 9 9 9 9\n");
    expect_refusal({"second-order tetrahedron", "Mesh.ElementOrder = 1"}, "2.msh", text);
}

TEST_F(ImportedMesh, broken_geometry_is_refused_with_its_place) {
    const std::string head = nodes_1 + "$ELM\n2\n1 4 5 1 4 1 2 3 4\n";
    expect_refusal({"tetrahedron 1 at (0.50, 0.25, 0.00) has no volume"}, "1.msh",
                   "$NOD\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 0 0\n$ENDNOD\n$ELM\n2\n"
                   "1 4 5 1 4 1 2 3 4\n2 4 5 1 4 1 2 3 5\n$ENDELM\n");
    // Node 9 lies on the same side of face 1 2 3 as node 4.
    expect_refusal({"tetrahedra 0 and 1 overlap at"}, "1.msh", head + "2 4 5 1 4 1 2 3 9\n$ENDELM\n");
    EXPECT_EQ(tetrahedra("1.msh", head + "2 4 5 1 4 4 1 2 3\n$ENDELM\n").tetrahedra.size(), 1U);
    EXPECT_TRUE(noted("1 tetrahedra that were there twice"));
}

TEST_F(ImportedMesh, parts_that_lie_on_each_other_without_sharing_nodes_are_refused) {
    expect_refusal(
        {"1 pairs of faces lie on each other", "Coherence"}, "1.msh",
        "$NOD\n8\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 0 0\n6 0 1 0\n7 0 0 1\n8 1 1 1\n$ENDNOD\n"
        "$ELM\n2\n1 4 5 1 4 1 2 3 4\n2 4 5 1 4 5 6 8 7\n$ENDELM\n");
}

TEST_F(ImportedMesh, parts_that_lie_in_the_same_place_are_refused) {
    const std::string nodes =
        "$NOD\n8\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 {0} 0.1 0.1\n6 {1} 0.1 0.1\n7 {0} {2} 0.1\n8 {0} 0.1 "
        "{2}\n"
        "$ENDNOD\n$ELM\n2\n1 4 5 1 4 1 2 3 4\n2 4 5 1 4 5 6 7 8\n$ENDELM\n";
    const auto with = [&](double first, double second, double other) {
        return fmt::format(fmt::runtime(nodes), first, second, other);
    };
    for (const std::string& text : {with(0.5, 1.5, 1.1), with(0.1, 0.2, 0.2)})  // through each other, within
        expect_refusal({"parts of it lie in the same place, at (", "join the parts"}, "1.msh", text);
    EXPECT_EQ(tetrahedra("1.msh", with(1.1, 2, 1.1)).tetrahedra.size(), 2U);
}

TEST_F(ImportedMesh, damaged_files_name_the_line) {
    expect_refusal({":12", "'four'", "a whole number"}, "1.msh",
                   nodes_1 + "$ELM\n1\n1 four 5 1 4 1 2 3 4\n$ENDELM\n");
    expect_refusal({"names node 77"}, "1.msh", nodes_1 + "$ELM\n1\n1 4 5 1 4 1 2 3 77\n$ENDELM\n");
    expect_refusal({"announces 99999999999 entries"}, "1.msh", "$NOD\n99999999999\n1 0 0 0\n$ENDNOD\n");
    expect_refusal({"ends too early"}, "2.msh", gmsh_2_binary().substr(0, 150));
    expect_refusal({"Gmsh format 4 ", "-format msh41"}, "4.msh", "$MeshFormat\n4 0 8\n$EndMeshFormat\n");
    expect_refusal({"holds no tetrahedra"}, "1.msh", nodes_1);
    expect_refusal({"'.step'"}, "body.step", "");
    for (std::size_t end = 1; end < gmsh_4.size(); end += 7) {  // a cut file is refused, never half read
        const std::string message = refusal("4.msh", gmsh_4.substr(0, end));
        EXPECT_EQ(message.find("nothing was thrown"), std::string::npos) << end;
    }
}

TEST_F(ImportedMesh, labels_give_regions_their_values_and_the_surface_its_neighbours) {
    TetMesh mesh = tetrahedra("2.msh", gmsh_2);
    LabelMap map;
    map.grid.size = {5, 5, 5};
    map.grid.origin = {-2, -2, -2};
    map.names = {{1, "kidney", {}}, {3, "liver", {}}};
    map.labels.assign(125, 1);
    adopt_labels(mesh, map);
    EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{3, 2}));
    EXPECT_EQ(mesh.region_names[0].name, "tumour of liver");
    EXPECT_EQ(mesh.outside_labels, (std::vector<std::int32_t>{1, 1, 1, 1, 1}));
    EXPECT_EQ(mesh.outside_names.at(0).name, "kidney");
    map.names = {{1, "kidney", {}}};
    EXPECT_THROW(adopt_labels(mesh, map), InvalidInput);
}

TEST_F(ImportedMesh, real_liver_of_gmsh_1_and_its_surface_are_sound) {
    REQUIRE_REAL_DATA(folder, "mesh_sofa");
    ImportedMeshOptions options;
    options.unit = "cm";
    const TetMesh mesh = read_imported_tetrahedra(folder / "liver.msh", options);
    EXPECT_EQ(mesh.rest_positions.size(), 181U);
    EXPECT_EQ(mesh.tetrahedra.size(), 596U);
    const MeshQuality quality = measure(mesh);
    EXPECT_EQ(quality.inverted, 0);
    EXPECT_TRUE(quality.boundary.closed_and_oriented());
    const SurfaceQuality smooth = measure(read_imported_surface(folder / "liver-smooth.obj", options));
    EXPECT_TRUE(smooth.closed_and_oriented());
    constexpr double coarser = 0.15;  // 596 tetrahedra cut corners off
    EXPECT_NEAR(quality.boundary.volume / smooth.volume, 1, coarser);
}

}  // namespace
}  // namespace palpate
