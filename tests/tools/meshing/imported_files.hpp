// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstring>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <string>
#include <unistd.h>

#include "formats/model/errors.hpp"
#include "tools/meshing/files/imported_mesh.hpp"

namespace palpate::test {

namespace fs = std::filesystem;

/// Writes files into a folder of the test's own and reads them as imported meshes and surfaces.
class ImportedFiles : public testing::Test {
  protected:
    ImportedFiles() {
        folder_ =
            fs::path(testing::TempDir()) / ("palpate_imported_" + std::to_string(getpid()) + "_" +
                                            testing::UnitTest::GetInstance()->current_test_info()->name());
        fs::create_directories(folder_);
    }
    ~ImportedFiles() override { fs::remove_all(folder_); }

    fs::path written(const std::string& name, const std::string& text) const {
        std::ofstream(folder_ / name, std::ios::binary) << text;
        return folder_ / name;
    }
    TetMesh tetrahedra(const std::string& name, const std::string& text,
                       const meshing::ImportedMeshOptions& options = {}) {
        return meshing::read_imported_tetrahedra(written(name, text), options,
                                                 [&](auto note) { notes_ += note; });
    }
    TriangleMesh surface(const std::string& name, const std::string& text,
                         const meshing::ImportedMeshOptions& options = {}) {
        return meshing::read_imported_surface(written(name, text), options,
                                              [&](auto note) { notes_ += note; });
    }
    // What reading a file is refused with.
    std::string refusal(const std::string& name, const std::string& text,
                        const meshing::ImportedMeshOptions& options = {}) {
        try {
            name.ends_with("msh") || name.ends_with("mesh") || name.ends_with("vtk") || name.ends_with("vtu")
                ? static_cast<void>(tetrahedra(name, text, options))
                : static_cast<void>(surface(name, text, options));
        } catch (const Error& error) {
            return error.what();
        }
        return "nothing was thrown";
    }
    void expect_refusal(std::initializer_list<const char*> phrases, const std::string& name,
                        const std::string& text, const meshing::ImportedMeshOptions& options = {}) {
        const std::string message = refusal(name, text, options);
        for (const char* phrase : phrases) EXPECT_NE(message.find(phrase), std::string::npos) << message;
    }
    bool noted(const char* phrase) const { return notes_.find(phrase) != std::string::npos; }

    fs::path folder_;
    std::string notes_;
};

/// The bytes of a number as this machine holds them.
template <typename T>
std::string bytes(T value) {
    std::string text(sizeof(T), '\0');
    std::memcpy(text.data(), &value, sizeof(T));
    return text;
}

}  // namespace palpate::test
