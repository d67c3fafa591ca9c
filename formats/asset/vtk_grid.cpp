// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/vtk_grid.hpp"

#include <algorithm>
#include <array>

#include "formats/asset/hdf5/hdf5_file.hpp"

namespace palpate::asset {
namespace {

constexpr std::uint8_t vtk_triangle = 5;
constexpr std::uint8_t vtk_tetra = 10;

struct Grid {
    std::vector<std::array<float, 3>> points;
    std::vector<std::int64_t> connectivity;
    std::vector<std::int64_t> offsets{0};
    std::vector<std::uint8_t> types;
    std::vector<std::int32_t> regions;
    std::vector<std::int32_t> bodies;
    std::vector<std::string> body_names, region_names;
    std::vector<std::int32_t> region_values, region_bodies;

    template <std::size_t n>
    void add_body(std::int32_t body, std::uint8_t type, const std::vector<Eigen::Vector3d>& positions,
                  const std::vector<std::array<std::int32_t, n>>& cells) {
        const auto base = static_cast<std::int64_t>(points.size());
        for (const Eigen::Vector3d& p : positions) {
            const Eigen::Vector3f rounded = p.cast<float>();
            points.push_back({rounded.x(), rounded.y(), rounded.z()});
        }
        for (const auto& cell : cells) {
            for (const std::int32_t index : cell) connectivity.push_back(base + index);
            offsets.push_back(static_cast<std::int64_t>(connectivity.size()));
        }
        types.insert(types.end(), cells.size(), type);
        bodies.insert(bodies.end(), cells.size(), body);
        regions.resize(bodies.size(), 0);
    }
};

Grid grid_of(const Case& patient_case) {
    Grid grid;
    for (const RigidBody& body : patient_case.rigid_bodies) {
        grid.add_body(static_cast<std::int32_t>(grid.body_names.size()), vtk_triangle, body.surface.vertices,
                      body.surface.triangles);
        grid.body_names.push_back(body.name);
    }
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        const auto index = static_cast<std::int32_t>(grid.body_names.size());
        const std::size_t first = grid.regions.size();
        grid.add_body(index, vtk_tetra, body.mesh.rest_positions, body.mesh.tetrahedra);
        std::copy(body.mesh.regions.begin(), body.mesh.regions.end(),
                  grid.regions.begin() + static_cast<std::ptrdiff_t>(first));
        for (const Label& region : body.mesh.region_names) {
            grid.region_values.push_back(region.value);
            grid.region_names.push_back(region.name);
            grid.region_bodies.push_back(index);
        }
        grid.body_names.push_back(body.name);
    }
    return grid;
}

void write_count(Hdf5Writer& writer, const std::string& name, std::size_t count) {
    const auto value = static_cast<std::int64_t>(count);
    writer.dataset("/VTKHDF/" + name, std::span(&value, 1), {1});  // VTK refuses a scalar here
}

template <typename T>
void write_list(Hdf5Writer& writer, const std::string& name, const std::vector<T>& values) {
    writer.dataset("/VTKHDF/" + name, std::span(values), {values.size()});
}

}  // namespace

void write_vtk_grid(Hdf5Writer& writer, const Case& patient_case) {
    const Grid grid = grid_of(patient_case);
    writer.group("/VTKHDF");
    writer.attribute("/VTKHDF", "Version", std::vector<std::int32_t>{1, 0});
    writer.attribute("/VTKHDF", "Type", "UnstructuredGrid");
    write_count(writer, "NumberOfPoints", grid.points.size());
    write_count(writer, "NumberOfCells", grid.types.size());
    write_count(writer, "NumberOfConnectivityIds", grid.connectivity.size());
    writer.dataset("/VTKHDF/Points",
                   std::span<const float>(grid.points.data()->data(), 3 * grid.points.size()),
                   {grid.points.size(), 3}, "mm");
    write_list(writer, "Connectivity", grid.connectivity);
    write_list(writer, "Offsets", grid.offsets);
    write_list(writer, "Types", grid.types);
    write_list(writer, "CellData/region", grid.regions);
    write_list(writer, "CellData/body", grid.bodies);
    writer.variable_texts("/VTKHDF/FieldData/SPACE", {"LPS"});
    writer.variable_texts("/VTKHDF/FieldData/body_names", grid.body_names);
    writer.variable_texts("/VTKHDF/FieldData/region_names", grid.region_names);
    write_list(writer, "FieldData/region_values", grid.region_values);
    write_list(writer, "FieldData/region_bodies", grid.region_bodies);
}

std::optional<std::string> vtk_grid_difference(const std::filesystem::path& path, const Case& patient_case) {
    const Hdf5File file(path);
    const Grid grid = grid_of(patient_case);
    std::optional<std::string> different;
    const auto compare = [&]<typename T>(const std::string& name, std::span<const T> values,
                                         std::vector<std::int64_t> shape) {
        const std::string dataset = "/VTKHDF/" + name;
        if (!std::ranges::equal(file.dataset<T>(dataset, shape), values)) different = dataset;
    };
    const auto compare_list = [&]<typename T>(const std::string& name, const std::vector<T>& values) {
        compare(name, std::span<const T>(values), {static_cast<std::int64_t>(values.size())});
    };
    const auto compare_count = [&](const std::string& name, std::size_t count) {
        compare_list(name, std::vector{static_cast<std::int64_t>(count)});
    };
    compare_count("NumberOfPoints", grid.points.size());
    compare_count("NumberOfCells", grid.types.size());
    compare_count("NumberOfConnectivityIds", grid.connectivity.size());
    compare("Points", std::span<const float>(grid.points.data()->data(), 3 * grid.points.size()),
            {static_cast<std::int64_t>(grid.points.size()), 3});
    compare_list("Connectivity", grid.connectivity);
    compare_list("Offsets", grid.offsets);
    compare_list("Types", grid.types);
    compare_list("CellData/region", grid.regions);
    compare_list("CellData/body", grid.bodies);
    compare_list("FieldData/region_values", grid.region_values);
    compare_list("FieldData/region_bodies", grid.region_bodies);
    return different;
}

}  // namespace palpate::asset
