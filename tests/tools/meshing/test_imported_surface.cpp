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
