// SPDX-License-Identifier: GPL-3.0-or-later
// write_fuzz_tool_samples FOLDER: small files that the readers of the tools take, in a folder for each
// reader.
#include "tests/formats/sample_case.hpp"
#include "tests/fuzz/samples/dicom_samples.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/meshing/files/mesh_files.hpp"

int main(int argc, char** argv) {
    using namespace palpate;
    if (argc != 2) return 2;
    const std::filesystem::path folder = argv[1];
    std::filesystem::create_directories(folder / "mesh");
    meshing::write_tetrahedra(folder / "mesh" / "cube.vtu", sample::cube_mesh(1, 20));
    meshing::write_surface(folder / "mesh" / "sphere.vtp", sample::sphere_surface({1, 2, 3}, 15, 0));

    std::filesystem::create_directories(folder / "label_map");
    ImageGrid grid;
    grid.size = {4, 5, 6};
    LabelMap map{grid, std::vector<std::uint16_t>(grid.voxel_count()), {{1, "liver", {1, 0.5F, 0}}}};
    Volume volume{grid, std::vector<float>(grid.voxel_count())};
    for (std::size_t v = 0; v < map.labels.size(); ++v) {
        map.labels[v] = v / 20 % 2;
        volume.values[v] = static_cast<float>(v * 37 % 101);
    }
    imaging::write_label_map(folder / "label_map" / "labels.seg.nrrd", map);
    imaging::write_volume(folder / "label_map" / "volume.nrrd", volume);
    fuzz::write_dicom_samples(folder / "dicom", map);
    return 0;
}
