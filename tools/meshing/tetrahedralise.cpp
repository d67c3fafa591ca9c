// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/tetrahedralise.hpp"

#include <algorithm>
#include <fmt/format.h>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/meshing/body_repair.hpp"
#include "tools/meshing/cgal_mesher.hpp"
#include "tools/meshing/fidelity.hpp"
#include "tools/meshing/lift_flat_tetrahedra.hpp"
#include "tools/meshing/outside_labels.hpp"
#include "tools/meshing/smoothed_labels.hpp"
#include "tools/meshing/surface_seeds.hpp"

namespace palpate {
namespace {

void require(bool sound, const char* field, double found, const char* expected) {
    if (!sound) throw InvalidInput({field, fmt::format("{}", found), expected, ""});
}

void check(const MeshSizing& sizing) {
    require(sizing.cell_size > 0, "cell size", sizing.cell_size, "more than 0 mm");
    require(sizing.facet_size >= 0, "facet size", sizing.facet_size, "0 or more mm");
    require(sizing.facet_distance >= 0, "facet distance", sizing.facet_distance, "0 or more mm");
    require(sizing.facet_angle_deg >= 0 && sizing.facet_angle_deg <= 30, "facet angle",
            sizing.facet_angle_deg, "0 ... 30 degrees, beyond which refinement may not end");
    require(sizing.cell_radius_edge >= 2, "cell radius over edge", sizing.cell_radius_edge,
            "2 or more, below which refinement may not end");
    for (const RegionSize& region : sizing.regions)
        require(region.cell_size > 0, "region cell size", region.cell_size, "more than 0 mm");
}

std::vector<RegionSizing> sizing_by_region(const MeshSizing& sizing, std::span<const std::int32_t> values) {
    std::vector<RegionSizing> result;
    for (const std::int32_t value : values) {
        const auto own = std::ranges::find(sizing.regions, value, &RegionSize::region);
        const double cell_size = own == sizing.regions.end() ? sizing.cell_size : own->cell_size;
        const double scale = cell_size / sizing.cell_size;
        result.push_back(
            {cell_size, scale * (sizing.facet_size > 0 ? sizing.facet_size : sizing.cell_size),
             scale * (sizing.facet_distance > 0 ? sizing.facet_distance : sizing.cell_size / 10)});
    }
    return result;
}

Label label_of(const LabelMap& map, std::int32_t value) {
    const auto found = std::ranges::find(map.names, value, &Label::value);
    return found != map.names.end()
               ? *found
               : Label{value, "label " + std::to_string(value), default_label_colour(value)};
}

std::vector<Label> labels_among(const LabelMap& map, const std::vector<std::int32_t>& values) {
    std::vector<Label> labels;
    for (const std::int32_t value : std::set(values.begin(), values.end()))
        if (value > 0) labels.push_back(label_of(map, value));
    return labels;
}

// Meshing needs something of every region left after specks are gone.
void require_every_region(const RegionLabels& labels, const LabelMap& map, double min_component_volume) {
    std::vector<std::int64_t> voxels(labels.values.size() + 1, 0);
    for (const std::uint8_t region : labels.regions) ++voxels[region];
    for (std::size_t region = 1; region < voxels.size(); ++region)
        if (voxels[region] == 0) {
            const Label label = label_of(map, labels.values[region - 1]);
            throw InvalidInput({fmt::format("label {} \"{}\"", label.value, label.name),
                                fmt::format("has no piece of {:g} mm³ or more", min_component_volume),
                                "1 or more",
                                "make the structure larger, or pass a smaller --min-component-volume"});
        }
}

// A component has arrived if at least half of its voxels lie in tetrahedra of its region.
void require_every_component(const TetMesh& mesh, const RegionLabels& labels, const LabelMap& map) {
    const LabelComponents found = find_components(labels);
    const std::vector<std::int32_t> painted = voxelise(mesh, labels.grid);
    std::vector<std::int64_t> covered(found.components.size(), 0);
    for (std::size_t v = 0; v < painted.size(); ++v)
        covered[static_cast<std::size_t>(found.component_of[v])] +=
            labels.regions[v] > 0 && painted[v] == labels.values[labels.regions[v] - 1U];
    for (std::size_t c = 0; c < covered.size(); ++c) {
        const LabelComponent& component = found.components[c];
        if (component.region == 0 || 2 * covered[c] >= component.voxels) continue;
        const Label label = label_of(map, labels.values[component.region - 1U]);
        const Eigen::Vector3d& p = component.centroid;
        throw QualityNotMet(
            {fmt::format("label {} \"{}\"", label.value, label.name),
             fmt::format(
                 "its component of {:.0f} mm³ around ({:.1f}, {:.1f}, {:.1f}) is {:.0f} % in the mesh",
                 static_cast<double>(component.voxels) * labels.grid.voxel_volume(), p.x(), p.y(), p.z(),
                 100.0 * static_cast<double>(covered[c]) / static_cast<double>(component.voxels)),
             "half of it or more", "give this label a smaller cell size, or smooth less"});
    }
}

}  // namespace

TetMesh tetrahedralise(const LabelMap& map, std::span<const std::int32_t> region_values,
                       const MeshSizing& sizing, const ProgressCallback& callback) {
    check(sizing);
    const ProgressCallback progress = callback ? callback : [](std::string_view, double) {};
    const double sigma = sizing.smoothing < 0 ? map.grid.spacing.maxCoeff() : sizing.smoothing;
    progress("smooth labels", 0);
    RegionLabels labels = cut_out_regions(map, region_values, smoothing_margin(map.grid, sigma));
    absorb_specks(labels, sizing.min_component_volume);
    require_every_region(labels, map, sizing.min_component_volume);
    const SmoothedLabels smoothed(labels, sigma);

    const std::vector<RegionSizing> region_sizing = sizing_by_region(sizing, labels.values);
    std::vector<double> seed_spacing;
    double finest = region_sizing.front().facet_distance;
    for (const RegionSizing& region : region_sizing) {
        seed_spacing.push_back(1.5 * region.facet_size);
        finest = std::min(finest, region.facet_distance);
    }
    progress("seed surfaces", 0.2);
    TetMesh mesh = mesh_smoothed_labels(smoothed, scatter_seeds(labels, smoothed, seed_spacing),
                                        region_sizing, sizing, progress);
    for (std::int32_t& region : mesh.regions) region = labels.values[static_cast<std::size_t>(region) - 1];

    progress("repair", 0.9);
    split_hinges(mesh);
    remove_crumbs(mesh, sizing.min_component_volume);
    // Matching volumes may take a tenth of an angle back.
    lift_flat_tetrahedra(mesh, sizing.min_dihedral_deg / 0.9, finest);
    std::vector<RegionVolume> targets;
    for (const std::int32_t value : labels.values) targets.push_back({value, 0});
    for (const std::uint8_t region : labels.regions)
        if (region > 0) targets[region - 1U].volume += labels.grid.voxel_volume();
    match_volumes(mesh, targets, finest);
    require_every_component(mesh, labels, map);

    mesh.region_names = labels_among(map, mesh.regions);
    mesh.outside_labels = outside_labels(mesh, map);
    mesh.outside_names = labels_among(map, mesh.outside_labels);
    return mesh;
}

}  // namespace palpate
