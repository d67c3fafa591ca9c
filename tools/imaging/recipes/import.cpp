// SPDX-License-Identifier: GPL-3.0-or-later
#include <cmath>
#include <optional>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/recipes/job.hpp"

namespace palpate::imaging {
namespace {

// The mask as seen from another grid: each voxel centre takes the value of the nearest voxel.
Mask resample(const Mask& mask, const ImageGrid& grid) {
    if (same_grid(mask.grid, grid)) return mask;
    Mask result{grid, std::vector<std::uint8_t>(grid.voxel_count(), 0)};
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < grid.size[2]; ++k)
        for (std::int32_t j = 0; j < grid.size[1]; ++j)
            for (std::int32_t i = 0; i < grid.size[0]; ++i, ++offset) {
                const Eigen::Vector3d index =
                    mask.grid.index_of(grid.point_of(Eigen::Vector3d(i, j, k))).array().round();
                const Eigen::Vector3i nearest = index.cast<std::int32_t>();
                if (mask.grid.contains(nearest[0], nearest[1], nearest[2]))
                    result.voxels[offset] = mask.voxels[mask.grid.offset(nearest[0], nearest[1], nearest[2])];
            }
    return result;
}

std::string imported_name(const Job& job) {
    return job.parameters.has("label") ? job.parameters.text("label") : job.structure.name;
}

Mask make_import(const Job& job) {
    const Parameters& p = job.parameters;
    std::optional<LabelMap> file;
    if (p.has("file")) file = read_label_map(p.text("file"));
    const LabelMap* source = file ? &*file : job.prior;
    if (source == nullptr)
        throw InvalidInput({job.culprit(), "there is no label map to import from", "",
                            "name one with file=... or beside the volume"});
    const std::string name = imported_name(job);
    if (name == "*") return resample(labelled(*source), job.map.grid);
    return resample(mask_of(*source, require_label(*source, name, job.culprit()).value), job.map.grid);
}

std::optional<std::array<float, 3>> imported_colour(const Job& job) {
    if (job.prior == nullptr || job.parameters.has("file")) return std::nullopt;
    const std::optional<Label> label = find_label(*job.prior, imported_name(job));
    return label ? std::optional(label->colour) : std::nullopt;
}

}  // namespace

Recipe import_recipe() {
    using enum RecipeParameter::Kind;
    return {.name = "import",
            .meaning = "a structure of a label map that was made before, with its colour",
            .parameters = concatenated(
                {{{"label", text, "", "",
                   "name or value in the label map, * for all of them [default: the structure's name]"},
                  {"file", file, "", "", "label map to read [default: the one given with the volume]"}},
                 region_parameters(),
                 cleaning_parameters()}),
            .if_empty = "check that both images show the same place, or the region and cleaning",
            .make = make_import,
            .colour = imported_colour};
}

}  // namespace palpate::imaging
