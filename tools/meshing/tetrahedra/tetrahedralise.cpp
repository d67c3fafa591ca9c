// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/tetrahedra/tetrahedralise.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <numbers>
#include <set>

#include "formats/model/errors.hpp"
#include "tools/meshing/labels/outside_labels.hpp"
#include "tools/meshing/tetrahedra/body_repair.hpp"
#include "tools/meshing/tetrahedra/cgal_mesher.hpp"
#include "tools/meshing/tetrahedra/lift_flat_tetrahedra.hpp"
#include "tools/meshing/tetrahedra/size_field.hpp"
#include "tools/meshing/tetrahedra/surface_fit.hpp"
#include "tools/meshing/tetrahedra/surface_seeds.hpp"

namespace palpate::meshing {
namespace {

void require(bool sound, const char* field, double found, const char* expected) {
    if (!sound) throw InvalidInput({field, fmt::format("{}", found), expected, ""});
}

void check(const MeshSizing& sizing) {
    require(sizing.cell_size > 0, "cell size", sizing.cell_size, "more than 0 mm");
    require(sizing.facet_size >= 0, "facet size", sizing.facet_size, "0 or more mm");
    require(sizing.facet_distance >= 0, "facet distance", sizing.facet_distance, "0 or more mm");
    require(sizing.max_gap >= 0, "largest gap", sizing.max_gap, "0 or more mm");
    require(sizing.facet_angle_deg >= 0 && sizing.facet_angle_deg <= 30, "facet angle",
            sizing.facet_angle_deg, "0 ... 30 degrees, beyond which refinement may not end");
    require(sizing.cell_radius_edge >= 2, "cell radius over edge", sizing.cell_radius_edge,
            "2 or more, below which refinement may not end");
    for (const RegionSize& region : sizing.regions) {
        require(region.cell_size >= 0, "region cell size", region.cell_size, "0 or more mm");
        require(region.surface_scale > 0, "region surface scale", region.surface_scale, "more than 0");
    }
    for (const NearSize& near : sizing.near) {
        require(near.cell_size > 0, "cell size near a place", near.cell_size, "more than 0 mm");
        require(near.within > 0, "distance to a place", near.within, "more than 0 mm");
    }
}

double volume_of(const RegionLabels& labels, std::size_t region) {
    return static_cast<double>(std::ranges::count(labels.regions, static_cast<std::uint8_t>(region))) *
           labels.grid.voxel_volume();
}

struct RegionShape {
    double volume = 0;  // mm³
    double area = 0;    // mm², of its surface

    // The radius of a ball, 1.5 thicknesses of a sheet, mm.
    double radius() const { return 3 * volume / area; }
};

// The faces of voxels add up to 1.5 times the area of the surface that they follow, averaged over its
// directions.
std::vector<RegionShape> shapes_of(const RegionLabels& labels) {
    std::vector<double> area(labels.values.size() + 1, 0.0);
    const std::array<std::size_t, 3> stride{1, static_cast<std::size_t>(labels.grid.size[0]),
                                            labels.grid.offset(0, 0, 1)};
    for (std::size_t axis = 0; axis < 3; ++axis) {
        const double face =
            labels.grid.voxel_volume() / labels.grid.spacing[static_cast<Eigen::Index>(axis)] / 1.5;
        for (std::size_t v = 0; v + stride[axis] < labels.regions.size(); ++v) {
            const std::uint8_t here = labels.regions[v], next = labels.regions[v + stride[axis]];
            if (here == next) continue;
            area[here] += face;
            area[next] += face;
        }
    }
    std::vector<RegionShape> shapes;
    for (std::size_t region = 1; region < area.size(); ++region)
        shapes.push_back({volume_of(labels, region), area[region]});
    return shapes;
}

// The body's sizes; a cell larger than the body says nothing.
LocalSizes body_sizes(const MeshSizing& sizing, const std::vector<RegionShape>& shapes) {
    const double cell =
        std::min(sizing.cell_size, std::ranges::max(shapes, {}, &RegionShape::radius).radius());
    return {cell, sizing.facet_size > 0 ? sizing.facet_size : cell,
            sizing.facet_distance > 0 ? sizing.facet_distance : cell / 10};
}

LocalSizes scaled(const LocalSizes& sizes, double cell_size) {
    const double scale = cell_size / sizes.cell;
    return {cell_size, scale * sizes.facet, scale * sizes.distance};
}

std::vector<LocalSizes> sizes_by_region(const MeshSizing& sizing, const LocalSizes& body,
                                        const std::vector<RegionShape>& shapes,
                                        const std::vector<std::int32_t>& values) {
    std::vector<LocalSizes> result;
    for (std::size_t k = 0; k < shapes.size(); ++k) {
        const auto found = std::ranges::find(sizing.regions, values[k], &RegionSize::region);
        const RegionSize own = found == sizing.regions.end() ? RegionSize{} : *found;
        LocalSizes sizes =
            scaled(body, own.cell_size > 0 ? own.cell_size : std::min(body.cell, shapes[k].radius()));
        sizes.facet *= own.surface_scale;
        sizes.distance *= own.surface_scale;
        result.push_back(sizes);
    }
    return result;
}

// The points of a place: those given, or the label's voxels, thinned to a fraction of the distance.
std::vector<Eigen::Vector3d> points_of(const NearSize& near, const LabelMap& map, double apart) {
    if (!near.points.empty()) return near.points;
    std::vector<Eigen::Vector3d> points;
    std::set<std::array<int, 3>> taken;
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < map.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < map.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < map.grid.size[0]; ++i, ++offset) {
                if (map.labels[offset] != near.label) continue;
                const Eigen::Vector3d p = map.grid.point_of(Eigen::Vector3d(i, j, k));
                const Eigen::Array3i cell = (p.array() / apart).floor().cast<int>();
                if (taken.insert({cell[0], cell[1], cell[2]}).second) points.push_back(p);
            }
    return points;
}

// The balls of a place, which may overlap.
std::vector<FineBall> balls_of(const NearSize& near, const LocalSizes& body, const LabelMap& map) {
    const double apart = near.points.empty() ? 0.5 * near.within : 0;
    std::vector<FineBall> balls;
    for (const Eigen::Vector3d& p : points_of(near, map, apart))
        balls.push_back({p, near.within + apart, scaled(body, near.cell_size)});
    return balls;
}

// mm³ of the regions inside balls: of balls that fall between voxels their own, and of few mm³ too, for which
// voxels are not worth counting.
double volume_inside(const std::vector<FineBall>& balls, const RegionLabels& labels, double few) {
    double balls_volume = 0, largest = 0;
    for (const FineBall& ball : balls) {
        balls_volume += 4 * std::numbers::pi / 3 * std::pow(ball.radius, 3);
        largest = std::max(largest, ball.radius);
    }
    if (balls_volume < few || largest < labels.grid.spacing.norm()) return balls_volume;
    SizeField field({}, largest);
    for (const FineBall& ball : balls) field.add(ball);
    std::int64_t inside = 0;
    std::size_t offset = 0;
    for (std::int32_t k = 0; k < labels.grid.size[2]; ++k)
        for (std::int32_t j = 0; j < labels.grid.size[1]; ++j)
            for (std::int32_t i = 0; i < labels.grid.size[0]; ++i)
                if (labels.regions[offset++] > 0 &&
                    std::isfinite(field.at(labels.grid.point_of(Eigen::Vector3d(i, j, k)), 0).cell))
                    ++inside;
    return std::min(balls_volume, static_cast<double>(inside) * labels.grid.voxel_volume());
}

// Adds up the tetrahedra to expect. Millions more than 20 take hours, and nothing can be done with them.
class Forecast {
  public:
    // `what` of `size` mm adds some; the first that makes them too many is refused.
    void add(const char* what, double size, double tetrahedra, const char* next_step) {
        constexpr double most = 20e6;
        expected_ += tetrahedra;
        if (expected_ > most)
            throw InvalidInput(
                {what,
                 fmt::format("{:g} mm would give some {:.0f} million tetrahedra", size, expected_ / 1e6),
                 "20 million at most", next_step});
    }

  private:
    double expected_ = 0;
};

constexpr double per_cubed_size = 4.4, per_squared_size = 3;  // measured on a liver

// A triangle of circumradius R lies R² / 2r off a surface of radius r.
void add_surfaces(Forecast& forecast, const std::vector<LocalSizes>& regions,
                  const std::vector<RegionShape>& shapes) {
    for (std::size_t k = 0; k < shapes.size(); ++k) {
        const LocalSizes& sizes = regions[k];
        const double by_size = sizes.facet * sizes.facet,
                     by_distance = 2 * sizes.distance * shapes[k].radius();
        const double expected = per_squared_size * shapes[k].area / std::min(by_size, by_distance);
        if (by_size < by_distance)
            forecast.add("facet size", sizes.facet, expected, "choose a larger --facet-size");
        else
            forecast.add("facet distance", sizes.distance, expected, "choose a larger --facet-distance");
    }
}

// Throws InvalidInput where more tetrahedra are to be expected than anyone can use.
SizeField size_field(const MeshSizing& sizing, const RegionLabels& labels, const LabelMap& map) {
    const std::vector<RegionShape> shapes = shapes_of(labels);
    const LocalSizes body = body_sizes(sizing, shapes);
    const std::vector<LocalSizes> regions = sizes_by_region(sizing, body, shapes, labels.values);
    Forecast forecast;
    for (std::size_t k = 0; k < shapes.size(); ++k)
        forecast.add("cell size", regions[k].cell,
                     per_cubed_size * shapes[k].volume / std::pow(regions[k].cell, 3),
                     "choose a larger --cell-size");
    add_surfaces(forecast, regions, shapes);
    constexpr double negligible = 1e5;  // tetrahedra
    double edge = body.cell;
    for (const NearSize& near : sizing.near) edge = std::max(edge, near.within);
    SizeField field(regions, edge);
    for (const NearSize& near : sizing.near) {
        const std::vector<FineBall> balls = balls_of(near, body, map);
        const double per_volume = per_cubed_size / std::pow(near.cell_size, 3);
        forecast.add("cell size near a place", near.cell_size,
                     per_volume * volume_inside(balls, labels, negligible / per_volume),
                     "choose a larger size or a shorter distance");
        for (const FineBall& ball : balls) field.add(ball);
    }
    return field;
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

}  // namespace

void require_coarser_than_round_off(const MeshSizing& sizing, const ImageGrid& grid) {
    const double least = grid.spacing.minCoeff() / 1000;
    const auto require_more = [&](const char* field, double found) {
        require(found >= least, field, found,
                fmt::format("{:g} mm or more, a thousandth of a voxel's edge", least).c_str());
    };
    require_more("cell size", sizing.cell_size);
    if (sizing.facet_size > 0) require_more("facet size", sizing.facet_size);
    if (sizing.facet_distance > 0) require_more("facet distance", sizing.facet_distance);
    for (const RegionSize& region : sizing.regions)
        if (region.cell_size > 0) require_more("region cell size", region.cell_size);
    for (const NearSize& near : sizing.near) require_more("cell size near a place", near.cell_size);
}

MeshDomain prepare_domain(const LabelMap& map, std::span<const std::int32_t> region_values, double smoothing,
                          double min_component_volume) {
    const double largest_edge = map.grid.spacing.maxCoeff();
    const double sigma = smoothing < 0 ? largest_edge : smoothing;
    require(sigma <= 10 * largest_edge, "smoothing", sigma, "10 voxel edges at most");
    RegionLabels labels = cut_out_regions(map, region_values, smoothing_margin(map.grid, sigma));
    absorb_specks(labels, min_component_volume);
    require_every_region(labels, map, min_component_volume);
    SmoothedLabels smoothed(labels, sigma);
    return {std::move(labels), std::move(smoothed)};
}

TetMesh tetrahedralise(const LabelMap& map, std::span<const std::int32_t> region_values,
                       const MeshSizing& sizing, const ProgressCallback& progress) {
    check(sizing);
    require_coarser_than_round_off(sizing, map.grid);
    return tetrahedralise(prepare_domain(map, region_values, sizing.smoothing, sizing.min_component_volume),
                          map, sizing, progress);
}

TetMesh tetrahedralise(const MeshDomain& domain, const LabelMap& map, const MeshSizing& sizing,
                       const ProgressCallback& callback) {
    check(sizing);
    const ProgressCallback progress = callback ? callback : [](std::string_view, double) {};
    const auto& [labels, smoothed] = domain;
    SizeField sizes = size_field(sizing, labels, map);
    const double max_gap = sizing.max_gap > 0 ? sizing.max_gap : 0.6 * map.grid.spacing.norm();

    progress("seed surfaces", 0.2);
    TetMesh mesh = mesh_smoothed_labels(
        smoothed, scatter_seeds(labels, smoothed, sizes), sizes, max_gap,
        {sizing.facet_angle_deg, sizing.cell_radius_edge, sizing.min_dihedral_deg}, progress);

    progress("repair", 0.9);
    split_hinges(mesh);
    part_pinched_edges(mesh);
    // A piece of just the smallest volume is smaller as a mesh, before volumes are matched.
    absorb_islands(mesh, 0.25 * sizing.min_component_volume);
    remove_crumbs(mesh, 0.25 * sizing.min_component_volume);
    // Each step leaves the next one a degree to spend.
    lift_flat_tetrahedra(mesh, sizing.min_dihedral_deg + 2, 0.5 * max_gap);
    fit_surface(mesh, smoothed, sizing.min_dihedral_deg + 1, max_gap);
    std::vector<double> volumes;
    for (std::size_t region = 1; region <= labels.values.size(); ++region)
        volumes.push_back(volume_of(labels, region));
    match_volumes(mesh, volumes, sizing.min_dihedral_deg, max_gap);

    for (std::int32_t& region : mesh.regions) region = labels.values[static_cast<std::size_t>(region) - 1];
    mesh.region_names = labels_among(map, mesh.regions);
    mesh.outside_labels = outside_labels(mesh, map);
    mesh.outside_names = labels_among(map, mesh.outside_labels);
    return mesh;
}

}  // namespace palpate::meshing
