// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <array>
#include <bit>

#include "tests/tools/meshing/imported_files.hpp"
#include "tools/meshing/files/mesh_files.hpp"
#include "tools/meshing/measures/quality.hpp"

namespace palpate {
namespace {

using namespace meshing;
using test::bytes;

class ImportedSurface : public test::ImportedFiles {};

// A tetrahedron; its last face is left out, turned, or as it should be.
std::string obj(const std::string& last) {
    return "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 2 3 4\nf 1 4 3\nf 1 2 4\n" + last;
}

TEST_F(ImportedSurface, surfaces_are_turned_outwards_and_joined) {
    const TriangleMesh sound = surface("a.obj", obj("f 1 3 2\n"));
    EXPECT_TRUE(measure(sound).closed_and_oriented());
    EXPECT_NEAR(measure(sound).volume, 1000.0 / 6, 1e-9);
    EXPECT_TRUE(measure(surface("b.obj", obj("f 1 2 3\n"))).closed_and_oriented());
    EXPECT_TRUE(noted("1 triangles turned to the side of their neighbours"));
    const std::string inwards = "v 0 0 0\nv 10 0 0\nv 0 10 0\nv 0 0 10\nf 2 4 3\nf 1 3 4\nf 1 4 2\nf 1 2 3\n";
    EXPECT_TRUE(measure(surface("c.obj", inwards)).closed_and_oriented());
    EXPECT_TRUE(noted("4 triangles turned: their piece faced inwards"));
}

TEST_F(ImportedSurface, of_several_pieces_those_inside_may_face_inwards) {
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

TEST_F(ImportedSurface, stl_in_either_kind_and_ply_are_read) {
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
    ImportedMeshOptions options;
    options.frame = "lps";
    expect_refusal({"states RAS"}, "b.stl", binary, options);
}

// The tetrahedron in STL.
constexpr std::array<std::array<int, 3>, 4> faces{{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}};

std::string binary_stl(const std::string& header, std::uint32_t count) {
    std::string text = header;
    text.resize(80, ' ');
    text += bytes(count);
    for (const auto& face : faces) {
        for (int c = 0; c < 3; ++c) text += bytes(0.0F);
        for (const int v : face)
            for (int axis = 0; axis < 3; ++axis) text += bytes(v == axis + 1 ? 10.0F : 0.0F);
        text += std::string(2, '\0');
    }
    return text;
}

std::string ascii_stl(const std::string& first_line, const std::string& indent, const std::string& line_end) {
    std::string text = first_line + line_end;
    for (const auto& face : faces) {
        text += indent + "facet normal 0 0 1" + line_end + indent + indent + "outer loop" + line_end;
        for (const int v : face) {
            text += indent + indent + indent + "vertex";
            for (int axis = 0; axis < 3; ++axis) text += v == axis + 1 ? " +1.000000e+01" : " 0.000000e+00";
            text += line_end;
        }
        text += indent + indent + "endloop" + line_end + indent + "endfacet" + line_end;
    }
    return text + "endsolid" + line_end;
}

TEST_F(ImportedSurface, stl_is_known_by_its_content) {
    const std::string byte_order_mark = "\xEF\xBB\xBF";
    for (const std::string& text :
         {ascii_stl("solid", "", "\n"), ascii_stl("solid vertex normal facet", "\t", "\r\n"),
          ascii_stl("solid vertex", std::string(7000, ' '), "\n"), ascii_stl("  \n solid ascii", "  ", "\n"),
          ascii_stl(byte_order_mark + "solid a", " ", "\n"),
          ascii_stl("SOLID " + std::string(200, 'n'), "", "\r\n"), binary_stl("solid exported by x", 4),
          binary_stl("solid exported by x", 0), binary_stl("", 4), binary_stl("facet vertex", 4)}) {
        const TriangleMesh read = surface("a.stl", text);
        EXPECT_EQ(read.triangles.size(), 4U) << text.substr(0, 80);
        EXPECT_NEAR(measure(read).volume, 1000.0 / 6, 1e-9);
    }
}

TEST_F(ImportedSurface, all_triangles_of_a_binary_stl_count_whatever_it_announces) {
    for (const std::uint32_t count : {0U, 3U, 5U, 0xFFFFFFFFU}) {
        notes_.clear();
        EXPECT_EQ(surface("a.stl", binary_stl("a", count)).triangles.size(), 4U) << count;
        EXPECT_TRUE(noted("triangles are announced and 4 there")) << count;
    }
    notes_.clear();
    EXPECT_EQ(surface("a.stl", binary_stl("a", 4) + "end").triangles.size(), 4U);
    EXPECT_TRUE(noted("3 bytes after the last triangle"));
    for (const std::uint32_t count : {0U, 4U})
        expect_refusal({"announces", "but 3 and 49 bytes follow"}, "b.stl",
                       binary_stl("solid b", count).substr(0, 84 + 199));
    expect_refusal({"open edges"}, "c.stl", binary_stl("c", 4).substr(0, 84 + 150));
}

TEST_F(ImportedSurface, obj_as_blender_and_meshlab_write_it_is_read) {
    const std::string places = "v 0 0 0\nv +10.0 0 0\nv 0 1e+1 0\nv 0 0 10\n";
    const std::string blender =
        "# Blender v2.93.0 OBJ File: ''\n# www.blender.org\nmtllib a.mtl\no Cube\n" + places +
        "vt 0.625000 0.500000\nvt 0.875 0.5\nvn 0.0000 1.0000 0.0000\nusemtl Material\ns off\n";
    const std::string meshlab =
        "####\n#\n# OBJ File Generated by Meshlab\n#\n####\n# Object a.obj\n#\n# Vertices: 4\n#\n####\n";
    const std::string coloured =
        "vn 0 0 1\nv 0 0 0 0.5 0.5 0.5\nvn 0 0 1\nv 10 0 0 0.5 0.5 0.5\nvn 0 0 1\nv 0 10 0 1 0 0\nvn 0 0 "
        "1\nv 0 0 10 1 0 0\n# 4 vertices, 0 vertices normals\n\n";
    for (const std::string& text :
         {blender +
              "f 2/1/1 3/2/1 4/1/1\nf 1/1/1 4/1/1 3/1/1\nf 1/2/1 2/2/1 4/1/1\ns 1\nf 1/1/1 3/1/1 2/2/1\n",
          meshlab + coloured +
              "f 2//2 3//3 4//4\nf 1//1 4//4 3//3\nf 1//1 2//2 4//4\nf 1//1 3//3 2//2\n"
              "# 4 faces, 0 coords texture\n\n# End of File",
          places + "g organ\nf -3/-1 -2/-1 -1/-1\nf 1 \\\n  4 3\nf 1 2 \\\r\n4\nf 1 3 2 # last\\"}) {
        const TriangleMesh read = surface("a.obj", text);
        EXPECT_EQ(read.vertices.size(), 4U) << text;
        EXPECT_NEAR(measure(read).volume, 1000.0 / 6, 1e-9) << text;
        EXPECT_FALSE(noted("turned")) << text;
    }
    const std::string pyramid =
        "v 0 0 0\nv 10 0 0\nv 10 10 0\nv 0 10 0\nv 5 5 10\nf 4 3 2 1\nf 1 2 5\n"
        "f 2 3 5\nf 3 4 5\nf 4 1 5\n";
    EXPECT_NEAR(measure(surface("p.obj", pyramid)).volume, 1000.0 / 3, 1e-9);
}

// A tetrahedron in PLY, with properties and an element that nobody needs.
std::string ply(const std::string& format, std::endian order) {
    std::string text = "ply\r\nformat " + format +
                       " 1.0\ncomment SPACE=RAS\nelement vertex 4\nproperty double x\nproperty double y\n"
                       "property uchar red\nproperty double z\nelement face 4\nproperty short flags\n"
                       "property list uchar int vertex_indices\nelement edge 1\nproperty list uint8 float w\n"
                       "end_header\n";
    const auto put = [&](auto value) {
        std::string raw = bytes(value);
        if (order != std::endian::native) std::ranges::reverse(raw);
        text += format == "ascii" ? std::to_string(value) + " " : raw;
    };
    for (int v = 0; v < 4; ++v) {
        put(v == 1 ? 10.0 : 0.0);
        put(v == 2 ? 10.0 : 0.0);
        put(std::uint8_t{7});
        put(v == 3 ? 10.0 : 0.0);
    }
    for (const std::array<int, 3>& face :
         std::vector<std::array<int, 3>>{{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}}) {
        put(std::int16_t{-1});
        put(std::uint8_t{3});
        for (const int v : face) put(v);
    }
    put(std::uint8_t{1});
    put(0.5F);
    return text;
}

TEST_F(ImportedSurface, ply_is_read_in_every_kind_and_refused_when_cut) {
    for (const auto& [format, order] : {std::pair<std::string, std::endian>{"ascii", std::endian::native},
                                        {"binary_little_endian", std::endian::little},
                                        {"binary_big_endian", std::endian::big}}) {
        SCOPED_TRACE(format);
        const std::string text = ply(format, order);
        const TriangleMesh read = surface("a.ply", text);
        EXPECT_TRUE(measure(read).closed_and_oriented());
        EXPECT_NEAR(measure(read).volume, 1000.0 / 6, 1e-9);
        EXPECT_TRUE(noted("in RAS"));
        const std::size_t end = format == "ascii" ? text.size() - 9 : text.size();  // before the last number
        for (std::size_t cut = 1; cut < end; cut += 7)
            EXPECT_EQ(refusal("b.ply", text.substr(0, cut)).find("nothing was thrown"), std::string::npos)
                << cut;
    }
}

TEST_F(ImportedSurface, damaged_ply_headers_are_refused) {
    const std::string sound = ply("binary_little_endian", std::endian::little);
    const auto with = [&](const std::string& what, const std::string& instead) {
        std::string text = sound;
        return text.replace(text.find(what), what.size(), instead);
    };
    expect_refusal({"'elemenx' in the header"}, "a.ply", with("element face", "elemenx face"));
    expect_refusal({"announces 999999999999 entries"}, "a.ply",
                   with("element face 4", "element face 999999999999"));
    expect_refusal({"announces -1 entries"}, "a.ply", with("element vertex 4", "element vertex -1"));
    expect_refusal({"property type '2147483647'"}, "a.ply", with("list uchar int", "list 2147483647 int"));
    expect_refusal({"without x, y and z"}, "a.ply", with("double y", "double q"));
    expect_refusal({"without a list vertex_indices"}, "a.ply", with("int vertex_indices", "int corners"));
    expect_refusal({"announces element vertex twice"}, "a.ply", with("element edge 1", "element vertex 1"));
    expect_refusal({"holds no faces"}, "a.ply", with("element face", "element fact"));
    expect_refusal({"names point"}, "a.ply", with(bytes(3) + bytes(2), bytes(-3) + bytes(2)));
    expect_refusal({"a face of 2 corners"}, "a.ply", with("\x03" + bytes(1), "\x02" + bytes(1)));
}

TEST_F(ImportedSurface, unsound_surfaces_are_refused_with_their_place) {
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

TEST_F(ImportedSurface, pieces_that_touch_in_a_point_are_parted) {
    const TriangleMesh pair = surface(
        "a.obj", obj("f 1 3 2\nv -10 0 0\nv 0 -10 0\nv 0 0 -10\nf 7 6 5\nf 6 7 1\nf 7 5 1\nf 5 6 1\n"));
    EXPECT_EQ(pair.vertices.size(), 8U);
    EXPECT_EQ(measure(pair).components, 2);
    EXPECT_TRUE(noted("1 vertices doubled"));
}

}  // namespace
}  // namespace palpate
