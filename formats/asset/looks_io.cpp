// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/looks_io.hpp"

#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "formats/model/errors.hpp"

namespace palpate::asset {
namespace {

using RowMajor = Eigen::Matrix<double, 3, 3, Eigen::RowMajor>;

constexpr const char* unit_of_ct = "HU";

[[noreturn]] void refuse_scan(const std::string& where, const std::string& found,
                              const std::string& expected) {
    throw InvalidInput({where, found, expected, "the file is damaged or foreign; make it again"});
}

void check_sizes(std::span<const std::uint64_t> sizes, const std::string& where) {
    constexpr std::uint64_t longest = 4096, most = std::uint64_t{1} << 26;
    std::uint64_t count = 1;
    for (const std::uint64_t size : sizes) {
        if (size < 1 || size > longest)
            refuse_scan(where, "has " + std::to_string(size) + " voxels along an axis",
                        "1 to " + std::to_string(longest));
        count *= size;
    }
    if (count > most)
        refuse_scan(where, "has " + std::to_string(count) + " voxels", std::to_string(most) + " at most");
}

void check_grid(const ImageGrid& grid, const std::string& where) {
    constexpr double finest = 1e-3, coarsest = 100;  // mm: from a micro-CT's voxels to no image at all
    if (!grid.origin.allFinite()) refuse_scan(where + "/origin", "is not finite", "mm");
    if (!(grid.spacing.array() >= finest && grid.spacing.array() <= coarsest).all())
        refuse_scan(where + "/spacing", "is out of range", "0.001 to 100 mm");
    if (!grid.direction.allFinite() || !grid.direction.isUnitary(1e-4))
        refuse_scan(where + "/direction", "is not orthonormal",
                    "unit directions at right angles, within 1e-4");
}

Eigen::Vector3d read_vector(const Hdf5File& file, const std::string& path) {
    return Eigen::Vector3d(file.dataset<double>(path, {3}).data());
}

Colour colour_from(const std::string& text, const Hdf5File& file, const std::string& path) {
    const auto colour = parse_colour(text);
    if (!colour) file.refuse(path, "is a colour of '" + text + "'", "such as #7a3a2f");
    return *colour;
}

}  // namespace

void check_scan(const Scan& scan, const std::string& where) {
    std::array<std::uint64_t, 3> sizes{};
    std::ranges::transform(scan.grid.size, sizes.begin(),
                           [](std::int32_t size) { return static_cast<std::uint64_t>(std::max(0, size)); });
    check_sizes(sizes, where + "/voxels");
    if (scan.values.size() != scan.grid.voxel_count())
        refuse_scan(where + "/voxels", "has " + std::to_string(scan.values.size()) + " values",
                    std::to_string(scan.grid.voxel_count()));
    check_grid(scan.grid, where);
}

void write_scan(Hdf5Writer& writer, const std::string& path, const Scan& scan) {
    const ImageGrid& grid = scan.grid;
    const auto length = [&](std::size_t axis) { return static_cast<std::uint64_t>(grid.size[axis]); };
    const RowMajor direction = grid.direction;
    writer.dataset(path + "/voxels", std::span(scan.values), {length(2), length(1), length(0)},
                   scan.hounsfield ? unit_of_ct : "");
    writer.dataset(path + "/origin", std::span<const double>(grid.origin.data(), 3), {3}, "mm");
    writer.dataset(path + "/spacing", std::span<const double>(grid.spacing.data(), 3), {3}, "mm");
    writer.dataset(path + "/direction", std::span<const double>(direction.data(), 9), {3, 3});
}

std::optional<Scan> read_scan(const Hdf5File& file, const std::string& path) {
    if (!file.contains(path)) return std::nullopt;
    constexpr auto any = Hdf5File::any;
    const std::string voxels = path + "/voxels";
    const auto values = file.dataset<std::int16_t>(voxels, {any, any, any});
    const Hdf5Shape& shape = file.objects().at(voxels).values->shape;
    check_sizes(shape, file.name() + ": " + voxels);
    Scan scan;
    for (std::size_t axis = 0; axis < 3; ++axis)
        scan.grid.size[axis] = static_cast<std::int32_t>(shape[2 - axis]);
    scan.grid.origin = read_vector(file, path + "/origin");
    scan.grid.spacing = read_vector(file, path + "/spacing");
    scan.grid.direction =
        Eigen::Map<const RowMajor>(file.dataset<double>(path + "/direction", {3, 3}).data());
    check_grid(scan.grid, file.name() + ": " + path);
    scan.hounsfield = file.has_attribute(voxels, "unit") && file.text_attribute(voxels, "unit") == unit_of_ct;
    scan.values.assign(values.begin(), values.end());
    return scan;
}

void write_colour(Hdf5Writer& writer, const std::string& path, const std::optional<Colour>& colour) {
    if (colour) writer.attribute(path, "colour", colour_text(*colour));
}

std::optional<Colour> read_colour(const Hdf5File& file, const std::string& path) {
    if (!file.has_attribute(path, "colour")) return std::nullopt;
    return colour_from(file.text_attribute(path, "colour"), file, path);
}

void write_region_colours(Hdf5Writer& writer, const std::string& path,
                          const std::vector<RegionColour>& colours) {
    if (colours.empty()) return;
    std::vector<std::int32_t> regions;
    std::vector<std::string> texts;
    for (const auto& [region, colour] : colours) {
        regions.push_back(region);
        texts.push_back(colour_text(colour));
    }
    writer.dataset(path + "/drawn_regions", std::span<const std::int32_t>(regions), {regions.size()});
    writer.texts(path + "/drawn_colours", texts, {texts.size()});
}

std::vector<RegionColour> read_region_colours(const Hdf5File& file, const std::string& path) {
    const std::string regions_path = path + "/drawn_regions", colours_path = path + "/drawn_colours";
    if (!file.contains(regions_path) && !file.contains(colours_path)) return {};
    const auto regions = file.dataset<std::int32_t>(regions_path, {Hdf5File::any});
    const auto texts = file.texts(colours_path, {static_cast<std::int64_t>(regions.size())});
    std::vector<RegionColour> colours;
    for (std::size_t i = 0; i < regions.size(); ++i)
        colours.push_back({regions[i], colour_from(texts[i], file, colours_path)});
    return colours;
}

}  // namespace palpate::asset
