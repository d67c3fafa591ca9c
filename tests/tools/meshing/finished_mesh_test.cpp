// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/finished_mesh.hpp"

#include <cstdlib>
#include <cstring>
#include <fstream>
#include <gtest/gtest.h>
#include <unistd.h>

#include "formats/model/errors.hpp"
#include "tools/meshing/mesh_files.hpp"
#include "tools/meshing/quality.hpp"

namespace palpate {
namespace {

namespace fs = std::filesystem;

class FinishedMesh : public testing::Test {
  protected:
    FinishedMesh() {
        folder_ =
            fs::path(testing::TempDir()) / ("palpate_finished_" + std::to_string(getpid()) + "_" +
                                            testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::create_directories(folder_);
    }
    ~FinishedMesh() override { fs::remove_all(folder_); }

    fs::path written(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return folder_ / name;
    }
    TetMesh tetrahedra(const std::string& name, const std::string& text,
                       const FinishedMeshOptions& options = {}) {
        return read_finished_tetrahedra(written(name, text), options, [&](auto note) { notes_ += note; });
    }
    TriangleMesh surface(const std::string& name, const std::string& text,
                         const FinishedMeshOptions& options = {}) {
        return read_finished_surface(written(name, text), options, [&](auto note) { notes_ += note; });
    }
    // What reading a file is refused with.
    std::string refusal(const std::string& name, const std::string& text,
                        const FinishedMeshOptions& options = {}) {
        try {
            name.ends_with("msh") || name.ends_with("mesh") || name.ends_with("vtk")
                ? static_cast<void>(tetrahedra(name, text, options))
                : static_cast<void>(surface(name, text, options));
        } catch (const Error& error) {
            return error.what();
        }
        return "nothing was thrown";
    }
    void expect_refusal(std::initializer_list<const char*> phrases, const std::string& name,
                        const std::string& text, const FinishedMeshOptions& options = {}) {
        const std::string message = refusal(name, text, options);
        for (const char* phrase : phrases) EXPECT_NE(message.find(phrase), std::string::npos) << message;
    }
    bool noted(const char* phrase) const { return notes_.find(phrase) != std::string::npos; }

    fs::path folder_;
    std::string notes_;
};

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

template <typename T>
std::string bytes(T value) {
    std::string text(sizeof(T), '\0');
    std::memcpy(text.data(), &value, sizeof(T));
    return text;
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

TEST_F(FinishedMesh, every_tetrahedral_format_gives_the_same_mesh) {
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

TEST_F(FinishedMesh, vtk_files_bring_regions_and_their_names) {
    const TetMesh mesh = tetrahedra("2.msh", gmsh_2);
    write_tetrahedra(folder_ / "a.vtu", mesh);
    const TetMesh again = read_finished_tetrahedra(folder_ / "a.vtu", {});
    expect_the_two_tetrahedra(again);
    EXPECT_EQ(again.region_names[1].name, "tumour of liver");
    expect_the_two_tetrahedra(tetrahedra("old.vtk",
                                         "# vtk DataFile Version 3.0\nx\nASCII\nDATASET "
                                         "UNSTRUCTURED_GRID\nPOINTS 5 double\n0 0 0 1 0 0 0 1 0 0 0 1 1 1 1\n"
                                         "CELLS 3 14\n4 0 1 2 3\n3 0 1 2\n4 1 2 4 3\nCELL_TYPES "
                                         "3\n10\n5\n10\nCELL_DATA 3\nSCALARS gmsh:physical int 1\n"
                                         "LOOKUP_TABLE default\n5\n3\n7\n"));
}

TEST_F(FinishedMesh, names_of_physical_groups_name_regions_and_options_overrule_them) {
    EXPECT_EQ(tetrahedra("4.msh", gmsh_4).region_names[1].name, "tumour of liver");
    EXPECT_EQ(tetrahedra("1.msh", gmsh_1).region_names[0].name, "region 5");
    FinishedMeshOptions options;
    options.region_names = {{7, "lesion"}};
    EXPECT_EQ(tetrahedra("4.msh", gmsh_4, options).region_names[1].name, "lesion");
    options.region_names = {{8, "lesion"}};
    expect_refusal({"has no region 8", "5, 7"}, "4.msh", gmsh_4, options);
}

TEST_F(FinishedMesh, unit_and_frame_place_the_mesh) {
    FinishedMeshOptions options;
    options.unit = "cm";
    options.frame = "ras";
    const TetMesh mesh = tetrahedra("1.msh", gmsh_1, options);
    EXPECT_EQ(mesh.rest_positions[4], Eigen::Vector3d(-10, -10, 10));
    EXPECT_GT(six_volume(mesh, 0), 999);
    EXPECT_TRUE(noted("10 x 10 x 10 mm, read as cm in RAS"));
    options.unit = "parsec";
    expect_refusal({"parsec", "mm, cm"}, "1.msh", gmsh_1, options);
}

TEST_F(FinishedMesh, region_zero_gets_the_next_free_value) {
    std::string text = medit;
    text.replace(text.find("3 4 5\n"), 6, "3 4 0\n");
    const TetMesh mesh = tetrahedra("m.mesh", text);
    EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{8, 7}));
    EXPECT_EQ(mesh.region_names[1].name, "region 0");
}

TEST_F(FinishedMesh, medit_files_of_tetgen_that_announce_too_many_triangles_are_read) {
    std::string text = medit;
    text.replace(text.find("Triangles\n1\n"), 12, "Triangles\n9\n");
    text.insert(text.find("Tetrahedra"), "# Set of Tetrahedra\n");
    expect_the_two_tetrahedra(tetrahedra("t.mesh", text));
    EXPECT_TRUE(noted("ignored 1 of kind 'triangle'"));
}

TEST_F(FinishedMesh, other_solid_cells_are_refused_by_kind) {
    std::string text = gmsh_2;
    text.replace(text.find("3 2 2 3 1 1 2 3\n"), 16, "3 7 2 5 1 1 2 3 4 9\n");
    expect_refusal({"1 of kind 'pyramid'", "linear tetrahedra"}, "2.msh", text);
    text = gmsh_2;
    text.replace(text.find("3 2 2 3 1 1 2 3\n"), 16, "3 11 2 5 1 1 2 3 4 9 9 9 9 9 9\n");
    expect_refusal({"second-order tetrahedron", "Mesh.ElementOrder = 1"}, "2.msh", text);
}

TEST_F(FinishedMesh, broken_geometry_is_refused_with_its_place) {
    const std::string head = nodes_1 + "$ELM\n2\n1 4 5 1 4 1 2 3 4\n";
    expect_refusal({"tetrahedron 1 at (0.50, 0.25, 0.00) has no volume"}, "1.msh",
                   "$NOD\n5\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 0 0\n$ENDNOD\n$ELM\n2\n"
                   "1 4 5 1 4 1 2 3 4\n2 4 5 1 4 1 2 3 5\n$ENDELM\n");
    // Node 9 lies on the same side of face 1 2 3 as node 4.
    expect_refusal({"tetrahedra 0 and 1 overlap at"}, "1.msh", head + "2 4 5 1 4 1 2 3 9\n$ENDELM\n");
    EXPECT_EQ(tetrahedra("1.msh", head + "2 4 5 1 4 4 1 2 3\n$ENDELM\n").tetrahedra.size(), 1U);
    EXPECT_TRUE(noted("1 tetrahedra that were there twice"));
}

TEST_F(FinishedMesh, parts_that_lie_on_each_other_without_sharing_nodes_are_refused) {
    expect_refusal(
        {"1 pairs of faces lie on each other", "Coherence"}, "1.msh",
        "$NOD\n8\n1 0 0 0\n2 1 0 0\n3 0 1 0\n4 0 0 1\n5 1 0 0\n6 0 1 0\n7 0 0 1\n8 1 1 1\n$ENDNOD\n"
        "$ELM\n2\n1 4 5 1 4 1 2 3 4\n2 4 5 1 4 5 6 8 7\n$ENDELM\n");
}

TEST_F(FinishedMesh, damaged_files_name_the_line) {
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

TEST_F(FinishedMesh, labels_give_regions_their_values_and_the_surface_its_neighbours) {
    TetMesh mesh = tetrahedra("2.msh", gmsh_2);
    LabelMap map;
    map.grid.size = {5, 5, 5};
    map.grid.origin = {-2, -2, -2};
    map.names = {{1, "kidney", {}}, {3, "liver", {}}};
    map.labels.assign(125, 1);
    adopt_labels(mesh, map);
    EXPECT_EQ(mesh.regions, (std::vector<std::int32_t>{3, 4}));
    EXPECT_EQ(mesh.region_names[1].name, "tumour of liver");
    EXPECT_EQ(mesh.outside_labels, (std::vector<std::int32_t>{1, 1, 1, 1, 1}));
    EXPECT_EQ(mesh.outside_names.at(0).name, "kidney");
    map.names = {{1, "kidney", {}}};
    EXPECT_THROW(adopt_labels(mesh, map), InvalidInput);
}

// A tetrahedron; its last face is left out, turned, or as it should be.
std::string obj(const std::string& last) {
    return "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 2 3 4\nf 1 4 3\nf 1 2 4\n" + last;
}

TEST_F(FinishedMesh, surfaces_are_turned_outwards_and_joined) {
    const TriangleMesh sound = surface("a.obj", obj("f 1 3 2\n"));
    EXPECT_TRUE(measure(sound).closed_and_oriented());
    EXPECT_NEAR(measure(sound).volume, 1000.0 / 6, 1e-9);
    EXPECT_TRUE(measure(surface("b.obj", obj("f 1 2 3\n"))).closed_and_oriented());
    EXPECT_TRUE(noted("1 triangles turned to the side of their neighbours"));
    const std::string inwards = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 2 4 3\nf 1 3 4\nf 1 4 2\nf 1 2 3\n";
    EXPECT_TRUE(measure(surface("c.obj", inwards)).closed_and_oriented());
    EXPECT_TRUE(noted("4 triangles turned: their piece faced inwards"));
}

TEST_F(FinishedMesh, of_several_pieces_those_inside_may_face_inwards) {
    const std::string inner = "v 1 1 1\nv 2 1 1\nv 1 2 1\nv 1 1 2\n";
    const std::string far = "v 30 0 0\nv 40 0 0\nv 30 10 0\nv 30 0 10\n";
    const std::string inwards = "f 6 8 7\nf 5 7 8\nf 5 8 6\nf 5 6 7\n";
    const TriangleMesh cavity = surface("cavity.obj", obj("f 1 3 2\n" + inner + inwards));
    EXPECT_NEAR(measure(cavity).volume, 999.0 / 6, 1e-9);
    EXPECT_FALSE(noted("faced inwards"));
    const TriangleMesh apart = surface("apart.obj", obj("f 1 3 2\n" + far + inwards));
    EXPECT_NEAR(measure(apart).volume, 2000.0 / 6, 1e-9);
    EXPECT_TRUE(noted("4 triangles turned: their piece faced inwards"));
}

TEST_F(FinishedMesh, stl_in_either_kind_and_ply_are_read) {
    const TriangleMesh sound = surface("a.obj", obj("f 1 3 2\n"));
    std::string ascii = "solid a\n", binary(80, ' ');
    binary.replace(0, 9, "SPACE=RAS");
    binary += bytes(static_cast<std::uint32_t>(sound.triangles.size()));
    std::string ply =
        "ply\nformat ascii 1.0\nelement vertex 4\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 4\nproperty list uchar int vertex_indices\nend_header\n"
        "0 0 0\n10 0 0\n0 10 0\n0 0 10\n3 1 2 3\n3 0 3 2\n3 0 1 3\n3 0 2 1\n";
    for (const Triangle& t : sound.triangles) {
        ascii += "facet normal 0 0 0\nouter loop\n";
        for (int c = 0; c < 3; ++c) binary += bytes(0.0F);
        for (const std::int32_t v : t) {
            ascii += "vertex";
            for (const double x : sound.vertices[static_cast<std::size_t>(v)]) {
                ascii += " " + std::to_string(x);
                binary += bytes(static_cast<float>(x));
            }
            ascii += "\n";
        }
        ascii += "endloop\nendfacet\n";
        binary += std::string(2, '\0');
    }
    for (const auto& [name, text] : {std::pair<std::string, std::string>{"a.stl", ascii + "endsolid a\n"},
                                     {"b.stl", binary},
                                     {"c.ply", ply}}) {
        SCOPED_TRACE(name);
        const TriangleMesh read = surface(name, text);
        EXPECT_EQ(read.vertices.size(), 4U);
        EXPECT_TRUE(measure(read).closed_and_oriented());
    }
    EXPECT_TRUE(noted("in RAS"));
    FinishedMeshOptions options;
    options.frame = "lps";
    expect_refusal({"states RAS"}, "b.stl", binary, options);
}

TEST_F(FinishedMesh, unsound_surfaces_are_refused_with_their_place) {
    expect_refusal({"3 open edges, the first at (5.0, 0.0, 0.0)", "close its holes"}, "a.obj", obj(""));
    expect_refusal({"edges of more than two triangles", "inner walls"}, "b.obj",
                   obj("f 1 3 2\nv 3 3 3\nf 1 2 5\nf 2 1 5\n"));
    expect_refusal({"triangle 4 has no area"}, "c.obj", obj("f 1 3 2\nv 20 0 0\nf 1 2 5\n"));
    expect_refusal({"not a readable"}, "d.vtp", "no mesh");
    expect_refusal(
        {"names point"}, "e.ply",
        "ply\nformat ascii 1.0\nelement vertex 1\nproperty float x\nproperty float y\nproperty float z\n"
        "element face 1\nproperty list uchar int vertex_indices\nend_header\n0 0 0\n3 0 1 2\n");
}

TEST_F(FinishedMesh, pieces_that_touch_in_a_point_are_parted) {
    const TriangleMesh pair = surface(
        "a.obj", obj("f 1 3 2\nv -10 0 0\nv 0 -10 0\nv 0 0 -10\nf 7 6 5\nf 6 7 1\nf 7 5 1\nf 5 6 1\n"));
    EXPECT_EQ(pair.vertices.size(), 8U);
    EXPECT_EQ(measure(pair).components, 2);
    EXPECT_TRUE(noted("1 vertices doubled"));
}

TEST_F(FinishedMesh, real_liver_of_gmsh_1_and_its_surface_are_sound) {
    const char* data = std::getenv("PALPATE_DATA");
    const fs::path folder = fs::path(data ? data : "") / "mesh_sofa";
    if (!data || !fs::is_directory(folder)) GTEST_SKIP() << "PALPATE_DATA: mesh_sofa is absent";
    FinishedMeshOptions options;
    options.unit = "cm";
    const TetMesh mesh = read_finished_tetrahedra(folder / "liver.msh", options);
    EXPECT_EQ(mesh.rest_positions.size(), 181U);
    EXPECT_EQ(mesh.tetrahedra.size(), 596U);
    const MeshQuality quality = measure(mesh);
    EXPECT_EQ(quality.inverted, 0);
    EXPECT_TRUE(quality.boundary.closed_and_oriented());
    const SurfaceQuality smooth = measure(read_finished_surface(folder / "liver-smooth.obj", options));
    EXPECT_TRUE(smooth.closed_and_oriented());
    constexpr double coarser = 0.15;  // 596 tetrahedra cut corners off
    EXPECT_NEAR(quality.boundary.volume / smooth.volume, 1, coarser);
}

}  // namespace
}  // namespace palpate
