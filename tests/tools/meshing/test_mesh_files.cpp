// SPDX-License-Identifier: GPL-3.0-or-later
#include <fstream>
#include <gtest/gtest.h>
#include <limits>
#include <sys/stat.h>
#include <unistd.h>

#include "formats/model/errors.hpp"
#include "tools/meshing/files/mesh_files.hpp"

namespace palpate {
namespace {

using namespace meshing;

namespace fs = std::filesystem;

class MeshFiles : public testing::Test {
  protected:
    MeshFiles() {
        folder_ =
            fs::path(testing::TempDir()) / ("palpate_mesh_files_" + std::to_string(getpid()) + "_" +
                                            testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::create_directories(folder_);
    }
    ~MeshFiles() override { fs::remove_all(folder_); }

    static std::string bytes(const fs::path& path) {
        std::ifstream stream(path, std::ios::binary);
        return {std::istreambuf_iterator<char>(stream), {}};
    }
    template <typename Function>
    static std::string message_of(Function&& function) {
        try {
            function();
        } catch (const Error& error) {
            return error.what();
        }
        return "nothing was thrown";
    }

    fs::path folder_;
};

// Two tetrahedra of different regions that share a face; coordinates that float32 cannot hold.
TetMesh two_tetrahedra() {
    TetMesh mesh;
    mesh.rest_positions = {{0, 0, 0}, {1.1, 0, 0}, {0, 1.3, 0}, {0, 0, 0.7}, {1, 1, 1}};
    mesh.tetrahedra = {{0, 1, 2, 3}, {1, 2, 3, 4}};
    mesh.regions = {3, 7};
    mesh.region_names = {{3, "liver", {0.5F, 0.25F, 0.125F}}, {7, "tumour", {0.1F, 0.2F, 0.3F}}};
    mesh.outside_labels = {0, 12, 0, -1, 0};
    mesh.outside_names = {{12, "right kidney", {0.7F, 0.8F, 0.9F}}};
    return mesh;
}

TriangleMesh tetrahedron_surface() {
    TriangleMesh surface;
    surface.vertices = {{0, 0, 0}, {1.1, 0, 0}, {0, 1.3, 0}, {0, 0, 0.7}};
    surface.triangles = {{1, 2, 3}, {0, 3, 2}, {0, 1, 3}, {0, 2, 1}};
    return surface;
}

void expect_same_labels(const std::vector<Label>& a, const std::vector<Label>& b) {
    ASSERT_EQ(a.size(), b.size());
    for (std::size_t i = 0; i < a.size(); ++i) {
        EXPECT_EQ(a[i].value, b[i].value);
        EXPECT_EQ(a[i].name, b[i].name);
        EXPECT_EQ(a[i].colour, b[i].colour);
    }
}

TEST_F(MeshFiles, that_are_pipes_are_refused) {
    ASSERT_EQ(mkfifo((folder_ / "a.vtu").c_str(), 0600), 0);
    EXPECT_NE(message_of([&] { read_tetrahedra(folder_ / "a.vtu"); }).find("is a pipe"), std::string::npos);
}

TEST_F(MeshFiles, surface_survives_writing_and_reading_bit_for_bit) {
    const TriangleMesh surface = tetrahedron_surface();
    write_surface(folder_ / "a.vtp", surface);
    const TriangleMesh read = read_surface(folder_ / "a.vtp");
    EXPECT_EQ(read.vertices, surface.vertices);
    EXPECT_EQ(read.triangles, surface.triangles);
}

TEST_F(MeshFiles, tetrahedra_survive_writing_and_reading_bit_for_bit) {
    const TetMesh mesh = two_tetrahedra();
    write_tetrahedra(folder_ / "a.vtu", mesh);
    const TetMesh read = read_tetrahedra(folder_ / "a.vtu");
    EXPECT_EQ(read.rest_positions, mesh.rest_positions);
    EXPECT_EQ(read.tetrahedra, mesh.tetrahedra);
    EXPECT_EQ(read.regions, mesh.regions);
    EXPECT_EQ(read.outside_labels, mesh.outside_labels);
    expect_same_labels(read.region_names, mesh.region_names);
    expect_same_labels(read.outside_names, mesh.outside_names);
}

TEST_F(MeshFiles, equal_meshes_give_equal_bytes) {
    write_tetrahedra(folder_ / "a.vtu", two_tetrahedra());
    write_tetrahedra(folder_ / "b.vtu", two_tetrahedra());
    EXPECT_EQ(bytes(folder_ / "a.vtu"), bytes(folder_ / "b.vtu"));
    write_surface(folder_ / "a.vtp", tetrahedron_surface());
    write_surface(folder_ / "b.vtp", tetrahedron_surface());
    EXPECT_EQ(bytes(folder_ / "a.vtp"), bytes(folder_ / "b.vtp"));
}

TEST_F(MeshFiles, inverted_tetrahedron_is_named) {
    TetMesh mesh = two_tetrahedra();
    std::swap(mesh.tetrahedra[1][0], mesh.tetrahedra[1][1]);
    write_tetrahedra(folder_ / "a.vtu", mesh);
    EXPECT_THROW(read_tetrahedra(folder_ / "a.vtu"), InvalidInput);
    EXPECT_NE(message_of([&] { read_tetrahedra(folder_ / "a.vtu"); }).find("tetrahedron 1 "),
              std::string::npos);
}

TEST_F(MeshFiles, index_out_of_range_is_refused) {
    TriangleMesh surface = tetrahedron_surface();
    surface.triangles[2][1] = 4;
    write_surface(folder_ / "a.vtp", surface);
    EXPECT_THROW(read_surface(folder_ / "a.vtp"), InvalidInput);
}

TEST_F(MeshFiles, number_that_is_not_finite_is_refused) {
    TriangleMesh surface = tetrahedron_surface();
    surface.vertices[3].y() = std::numeric_limits<double>::quiet_NaN();
    write_surface(folder_ / "a.vtp", surface);
    EXPECT_NE(message_of([&] { read_surface(folder_ / "a.vtp"); }).find("point 3 is not finite"),
              std::string::npos);
}

TEST_F(MeshFiles, background_region_is_refused) {
    TetMesh mesh = two_tetrahedra();
    mesh.regions[0] = 0;
    write_tetrahedra(folder_ / "a.vtu", mesh);
    EXPECT_THROW(read_tetrahedra(folder_ / "a.vtu"), InvalidInput);
}

TEST_F(MeshFiles, empty_mesh_is_refused) {
    write_surface(folder_ / "a.vtp", TriangleMesh{});
    EXPECT_THROW(read_surface(folder_ / "a.vtp"), InvalidInput);
    write_tetrahedra(folder_ / "a.vtu", TetMesh{});
    EXPECT_THROW(read_tetrahedra(folder_ / "a.vtu"), InvalidInput);
}

TEST_F(MeshFiles, missing_foreign_and_truncated_files_are_refused) {
    EXPECT_THROW(read_surface(folder_ / "absent.vtp"), InvalidInput);
    std::ofstream(folder_ / "text.vtp") << "not a mesh";
    EXPECT_THROW(read_surface(folder_ / "text.vtp"), InvalidInput);
    write_tetrahedra(folder_ / "a.vtu", two_tetrahedra());
    EXPECT_THROW(read_surface(folder_ / "a.vtu"), InvalidInput);
    const std::string whole = bytes(folder_ / "a.vtu");
    std::ofstream(folder_ / "half.vtu", std::ios::binary) << whole.substr(0, whole.size() * 3 / 4);
    EXPECT_THROW(read_tetrahedra(folder_ / "half.vtu"), InvalidInput);
}

TEST_F(MeshFiles, full_disk_is_noticed) {
    if (!fs::exists("/dev/full")) GTEST_SKIP() << "/dev/full is absent";
    // Through a link, because VTK removes what it could not finish.
    fs::create_symlink("/dev/full", folder_ / "full.vtp");
    EXPECT_THROW(write_surface(folder_ / "full.vtp", tetrahedron_surface()), SystemFailure);
    EXPECT_TRUE(fs::exists("/dev/full"));
    EXPECT_THROW(write_surface(folder_ / "no" / "such" / "a.vtp", tetrahedron_surface()), SystemFailure);
}

}  // namespace
}  // namespace palpate
