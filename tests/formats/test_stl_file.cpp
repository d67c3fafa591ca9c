// SPDX-License-Identifier: Apache-2.0
#include <Eigen/Geometry>
#include <cstring>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <sstream>
#include <sys/stat.h>

#include "formats/stl_file/read_stl.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using Eigen::Vector3f;
using ::testing::HasSubstr;
using Facets = std::vector<std::array<Vector3f, 3>>;

const Facets tetrahedron = {{{{0, 0, 0}, {0, 10, 0}, {10, 0, 0}}},
                            {{{0, 0, 0}, {10, 0, 0}, {0, 0, 10}}},
                            {{{0, 0, 0}, {0, 0, 10}, {0, 10, 0}}},
                            {{{10, 0, 0}, {0, 10, 0}, {0, 0, 10}}}};

Facets facets_of(const TriangleMesh& mesh) {
    Facets facets;
    for (const Triangle& t : mesh.triangles)
        for (auto& facet = facets.emplace_back(); const std::size_t i : {0, 1, 2})
            facet[i] = mesh.vertices[static_cast<std::size_t>(t[i])].cast<float>();
    return facets;
}

std::string binary(const Facets& facets, const std::string& header = "made by a test") {
    std::string bytes = header;
    bytes.resize(80, ' ');
    const auto append = [&](const void* data, std::size_t size) {
        bytes.append(static_cast<const char*>(data), size);
    };
    const auto count = static_cast<std::uint32_t>(facets.size());
    append(&count, sizeof count);
    for (const auto& facet : facets) {
        bytes.append(12, '\0');
        for (const Vector3f& corner : facet) append(corner.data(), 12);
        bytes.append(2, '\0');
    }
    return bytes;
}

std::string ascii(const Facets& facets) {
    std::ostringstream text;
    text << "solid a tool\n";
    for (const auto& facet : facets) {
        text << "facet normal -nan(ind) 0 1e0\n outer loop\n";
        for (const Vector3f& p : facet)
            text << "  vertex " << p.x() << ' ' << std::showpos << p.y() << std::noshowpos << ' ' << p.z()
                 << '\n';
        text << " endloop\nendfacet\n";
    }
    text << "endsolid a tool\n";
    return text.str();
}

TriangleMesh read(const std::string& bytes) {
    const sample::Scratch scratch;
    std::ofstream(scratch / "a.stl", std::ios::binary) << bytes;
    return stl_file::read_stl(scratch / "a.stl");
}

// What a file is refused with, "" if it is read.
std::string outcome(const std::string& bytes) {
    return sample::refusal([&] { read(bytes); });
}

std::string replaced(std::string text, const std::string& old, const std::string& by) {
    return text.replace(text.find(old), old.size(), by);
}

double volume(const TriangleMesh& mesh) {
    double sum = 0;
    const auto at = [&](std::int32_t v) { return mesh.vertices[static_cast<std::size_t>(v)]; };
    for (const Triangle& t : mesh.triangles) sum += at(t[0]).dot(at(t[1]).cross(at(t[2]))) / 6;
    return sum;
}

void expect_same(const TriangleMesh& a, const TriangleMesh& b) {
    EXPECT_EQ(a.vertices, b.vertices);
    EXPECT_EQ(a.triangles, b.triangles);
}

TEST(StlFile, a_surface_is_read_back_from_either_form) {
    const Facets facets = facets_of(sample::sphere_surface({0, 0, 0}, 8, 2));
    const TriangleMesh mesh = read(binary(facets));
    ASSERT_EQ(mesh.triangles.size(), facets.size());
    EXPECT_EQ(mesh.vertices.size(), facets.size() / 2 + 2) << "Euler";
    for (std::size_t t = 0; t < facets.size(); ++t)
        for (std::size_t i = 0; i < 3; ++i)
            EXPECT_EQ(mesh.vertices[static_cast<std::size_t>(mesh.triangles[t][i])],
                      facets[t][i].cast<double>());
    expect_same(read(ascii(tetrahedron)), read(binary(tetrahedron)));
}

TEST(StlFile, text_may_be_in_any_case_and_broken_anywhere) {
    std::string loud = ascii(tetrahedron);
    for (char& c : loud) c = static_cast<char>(std::toupper(c));
    expect_same(read(loud), read(binary(tetrahedron)));
    std::string crowded = ascii(tetrahedron);
    for (std::size_t i = crowded.find('\n') + 1; i < crowded.size(); ++i)
        if (crowded[i] == '\n') crowded[i] = '\t';
    expect_same(read(crowded), read(binary(tetrahedron)));
    std::string of_windows;
    for (const char c : ascii(tetrahedron)) of_windows += c == '\n' ? "\r\n" : std::string(1, c);
    expect_same(read(of_windows), read(binary(tetrahedron)));
}

TEST(StlFile, several_solids_of_a_text_are_one_surface) {
    const Facets half(tetrahedron.begin(), tetrahedron.begin() + 2);
    const Facets rest(tetrahedron.begin() + 2, tetrahedron.end());
    expect_same(read(ascii(half) + ascii(rest)), read(ascii(tetrahedron)));
}

TEST(StlFile, a_binary_file_may_say_solid) {
    expect_same(read(binary(tetrahedron, "solid facet vertex")), read(binary(tetrahedron)));
    EXPECT_THAT(outcome(binary(tetrahedron, "solid").substr(0, 200)), HasSubstr("announces 4 triangles"));
}

TEST(StlFile, corners_at_one_place_are_one_vertex) {
    Facets facets = tetrahedron;
    for (auto& facet : facets)
        for (Vector3f& corner : facet)
            if (corner.x() == 0 && corner.y() == 0) corner.x() = -0.0F;
    const TriangleMesh mesh = read(binary(facets));
    ASSERT_EQ(mesh.vertices.size(), 4);
    EXPECT_EQ(mesh.vertices[1], Eigen::Vector3d(0, 10, 0)) << "in the order of the file";
}

TEST(StlFile, triangles_of_two_corners_at_one_place_are_left_out) {
    Facets facets = tetrahedron;
    facets.insert(facets.begin(), {{{1, 2, 3}, {1, 2, 3}, {7, 8, 9}}});
    facets.push_back({{{1, 1, 1}, {1, 1, 1}, {1, 1, 1}}});
    expect_same(read(binary(facets)), read(binary(tetrahedron)));
}

TEST(StlFile, a_surface_that_is_inside_out_is_turned_round) {
    Facets facets = tetrahedron;
    for (auto& facet : facets) std::swap(facet[1], facet[2]);
    EXPECT_NEAR(volume(read(binary(facets))), 1000.0 / 6, 1e-9);
    EXPECT_NEAR(volume(read(binary(tetrahedron))), 1000.0 / 6, 1e-9);
}

TEST(StlFile, a_needle_far_from_the_origin_has_a_volume) {
    Facets facets = tetrahedron;
    for (auto& facet : facets)
        for (Vector3f& corner : facet)
            corner = corner.cwiseProduct(Vector3f(15, 0.01F, 0.01F)) + Vector3f(0, 0, 500);
    EXPECT_EQ(outcome(binary(facets)), "");
}

TEST(StlFile, a_file_that_is_none_is_refused) {
    const sample::Scratch scratch;
    const auto refusal = [&](const char* name) {
        return sample::refusal([&] { stl_file::read_stl(scratch / name); });
    };
    EXPECT_THAT(refusal("absent.stl"), HasSubstr("absent.stl: cannot be read"));
    EXPECT_THAT(refusal("."), HasSubstr("is a folder"));
    ASSERT_EQ(mkfifo((scratch / "pipe").c_str(), 0600), 0);
    EXPECT_THAT(refusal("pipe"), HasSubstr("is a pipe"));
    std::ofstream(scratch / "large.stl") << "solid";
    std::filesystem::resize_file(scratch / "large.stl", 84 + 50 * (1 << 20) + 1);
    EXPECT_THAT(refusal("large.stl"), HasSubstr("has 52428885 bytes (expected 52428884 at most)"));
}

TEST(StlFile, what_is_neither_form_or_cut_short_is_refused) {
    EXPECT_THAT(outcome(""), HasSubstr("is no STL: has 0 bytes"));
    EXPECT_THAT(outcome("a letter"), HasSubstr("is no STL: has 8 bytes (expected 84 or more, or a text"));
    const std::string whole = binary(tetrahedron);
    EXPECT_THAT(outcome(whole.substr(0, whole.size() - 1)),
                HasSubstr("a.stl: has 283 bytes and announces 4 triangles (expected 284 bytes)"));
    EXPECT_THAT(outcome(whole + " "), HasSubstr("has 285 bytes and announces 4 triangles"));
    const std::string text = ascii(tetrahedron);
    EXPECT_THAT(outcome(text.substr(0, text.find("endsolid"))),
                HasSubstr("a.stl:30: the text ends (expected \"facet\" or \"endsolid\")"));
    EXPECT_THAT(outcome(text.substr(0, text.find("endloop"))), HasSubstr("the text ends (expected endloop)"));
}

TEST(StlFile, a_text_is_refused_by_its_line) {
    const std::string text = ascii(tetrahedron);
    EXPECT_THAT(outcome(replaced(text, "endloop", "  vertex 1 2 3")),
                HasSubstr("a.stl:7: finds \"vertex\" (expected endloop); write the file again"));
    EXPECT_THAT(outcome(replaced(text, "vertex 0", "vertex 0,5")),
                HasSubstr("a.stl:4: finds \"0,5\" (expected a number)"));
    EXPECT_THAT(outcome(replaced(text, "vertex 0", "vertex 0x1\a")), HasSubstr("finds \"0x1?\""));
    EXPECT_THAT(outcome(text + "loose words"), HasSubstr("finds \"loose\" (expected \"solid\", or the end)"));
    EXPECT_THAT(outcome(replaced(text, "solid a tool", "solids")), HasSubstr("a.stl:1: finds \"solids\""));
}

TEST(StlFile, a_corner_that_is_not_finite_or_ten_metres_away_is_refused) {
    for (const float bad :
         {std::numeric_limits<float>::quiet_NaN(), std::numeric_limits<float>::infinity()}) {
        Facets facets = tetrahedron;
        facets[2][1].y() = bad;
        EXPECT_THAT(outcome(binary(facets)), HasSubstr("a.stl: has a corner that is not finite"));
        EXPECT_THAT(outcome(ascii(facets)), HasSubstr("a.stl:19: has a corner that is not finite"));
    }
    Facets facets = tetrahedron;
    facets[0][0].z() = -10001;
    EXPECT_THAT(outcome(binary(facets)),
                HasSubstr("has a corner with coordinate -10001 (expected 10000 mm at most)"));
    EXPECT_THAT(outcome(replaced(ascii(tetrahedron), "vertex 0", "vertex 1e300")), HasSubstr("1e+300"));
}

TEST(StlFile, a_surface_that_is_not_closed_is_refused) {
    Facets open = tetrahedron;
    open.pop_back();
    EXPECT_THAT(outcome(binary(open)),
                HasSubstr("a.stl: is not closed: the edge from (0, 10, 0) to (10, 0, 0) mm belongs to one "
                          "triangle (expected two, which face the same side)"));
    Facets turned = tetrahedron;
    std::swap(turned[1][0], turned[1][1]);
    EXPECT_THAT(outcome(binary(turned)), HasSubstr("belongs to two triangles that face opposite sides"));
    Facets twice = tetrahedron;
    for (auto facet : tetrahedron) {
        for (Vector3f& corner : facet) corner.z() *= -1;
        std::swap(facet[0], facet[1]);
        twice.push_back(facet);
    }
    EXPECT_THAT(outcome(binary(twice)), HasSubstr("belongs to 4 triangles"));
}

TEST(StlFile, a_surface_without_triangles_or_volume_is_refused) {
    EXPECT_THAT(outcome(binary({})), HasSubstr("holds no triangles"));
    EXPECT_THAT(outcome("solid nothing\nendsolid\n"), HasSubstr("holds no triangles"));
    EXPECT_THAT(outcome(binary({{{{1, 1, 1}, {1, 1, 1}, {2, 2, 2}}}})), HasSubstr("holds no triangles"));
    Facets flat = tetrahedron;
    for (auto& facet : flat)
        for (Vector3f& corner : facet) corner.z() = corner.x() / 3;
    EXPECT_THAT(outcome(binary(flat)), HasSubstr("encloses no volume"));
}

}  // namespace
}  // namespace palpate
