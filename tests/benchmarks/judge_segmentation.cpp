// SPDX-License-Identifier: GPL-3.0-or-later
// What tests/benchmarks/measure_segmentation.py asks of label maps; prints JSON.
//   score RESULT LABEL REFERENCE LABEL [VOLUME PICTURE.png]   overlap, surface distance, volumes, pieces
//   seeds REFERENCE LABEL COUNT RANDOM MARGIN_MM              points at least so deep inside, "x,y,z;x,y,z"
//   grow VOLUME NAME=X,Y,Z ...                                seconds of a preview and of a full growth
#include <algorithm>
#include <chrono>
#include <fmt/format.h>
#include <fmt/ranges.h>
#include <fstream>
#include <iostream>
#include <random>
#include <sstream>

#include "formats/model/errors.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/voxels/grow_from_seeds.hpp"
#include "tools/imaging/voxels/label_statistics.hpp"
#include "tools/imaging/voxels/mask.hpp"
#include "tools/report/pictures/slices.hpp"

namespace {

using namespace palpate;
using namespace palpate::imaging;
using namespace palpate::report;

Mask mask_of(const std::string& path, const std::string& name) {
    const LabelMap map = read_label_map(path);
    const auto value = name == "*" ? 0 : require_label(map, name, path).value;
    Mask mask{map.grid, {}};
    for (const std::uint16_t label : map.labels)
        mask.voxels.push_back(name == "*" ? label != 0 : label == value);
    return mask;
}

// Distances (mm) from the voxels on the border of `a` to the nearest voxel on that of `b`.
void append_distances(const Mask& a, const Mask& b, std::vector<float>& distances) {
    const auto border = [&](const Mask& mask) {
        Mask shell = mask;
        const auto& n = mask.grid.size;
        for (int k = 0; k < n[2]; ++k)
            for (int j = 0; j < n[1]; ++j)
                for (int i = 0; i < n[0]; ++i) {
                    const auto in = [&](int x, int y, int z) {
                        return !mask.grid.contains(x, y, z) || mask.voxels[mask.grid.offset(x, y, z)];
                    };
                    if (in(i - 1, j, k) && in(i + 1, j, k) && in(i, j - 1, k) && in(i, j + 1, k) &&
                        in(i, j, k - 1) && in(i, j, k + 1))
                        shell.voxels[mask.grid.offset(i, j, k)] = 0;
                }
        return shell;
    };
    const Mask from = border(a);
    const std::vector<float> to = distance_to(border(b));
    for (std::size_t i = 0; i < to.size(); ++i)
        if (from.voxels[i]) distances.push_back(to[i]);
}

void write_picture(const Mask& result, const Mask& reference, const std::string& volume_path,
                   const std::string& path) {
    const Volume volume = read_volume(volume_path);
    LabelMap map{
        result.grid, {}, {{1, "result", {0, 1, 0}}, {2, "missed", {0, 0.4F, 1}}, {3, "extra", {1, 0, 0}}}};
    for (std::size_t i = 0; i < result.voxels.size(); ++i)
        map.labels.push_back(result.voxels[i] ? (reference.voxels[i] ? 1 : 3)
                                              : (reference.voxels[i] ? 2 : 0));
    const Eigen::Vector3d extent =
        Eigen::Vector3d(result.grid.size[0] - 1, result.grid.size[1] - 1, result.grid.size[2] - 1);
    const Eigen::Vector3d center = result.grid.point_of(extent / 2);
    const Eigen::Vector3d low = result.grid.point_of(Eigen::Vector3d::Zero()),
                          high = result.grid.point_of(extent);
    const Eigen::Vector3d size = (high - low).cwiseAbs();
    constexpr int across = 4, down = 3, side = 360;
    Picture all{across * side, down * side,
                std::vector<std::uint8_t>(std::size_t{3} * across * side * down * side)};
    for (int n = 0; n < across * down; ++n) {
        SliceWindow window;
        window.pixels = side;
        window.plane = n < 8 ? Plane::axial : n < 10 ? Plane::coronal : Plane::sagittal;
        const int axis = n < 8 ? 2 : n < 10 ? 1 : 0;
        window.side = axis == 2 ? std::max(size[0], size[1]) : size.maxCoeff();
        window.center = center;
        const double at = n < 8 ? (n + 1.0) / 9 : (n % 2 == 0 ? 0.4 : 0.6);
        window.center[axis] = std::min(low[axis], high[axis]) + size[axis] * (axis == 0 ? at - 0.15 : at);
        const Picture part = slice_picture(window, &volume, &map);
        for (int y = 0; y < side; ++y)
            std::copy_n(part.rgb.begin() + static_cast<std::ptrdiff_t>(part.offset(0, y)), 3 * side,
                        all.rgb.begin() + static_cast<std::ptrdiff_t>(
                                              all.offset(n % across * side, n / across * side + y)));
    }
    std::ofstream(path, std::ios::binary) << png_bytes(all);
}

void score(const std::vector<std::string>& words) {
    const Mask result = mask_of(words.at(0), words.at(1)), reference = mask_of(words.at(2), words.at(3));
    if (!same_grid(result.grid, reference.grid))
        throw InvalidInput({words[0], "is on another grid than " + words[2], "", ""});
    std::vector<float> distances;
    append_distances(result, reference, distances);
    append_distances(reference, result, distances);
    std::ranges::sort(distances);
    const double both = static_cast<double>(intersect(result, reference).count()),
                 sum = static_cast<double>(result.count() + reference.count());
    const double ml = result.grid.voxel_volume() / 1000;
    std::cout << fmt::format(
        "{{\"dice\": {:.4f}, \"distance_95_mm\": {:.2f}, \"volume_ml\": {:.1f}, \"reference_ml\": {:.1f}, "
        "\"pieces\": {}}}\n",
        2 * both / sum, distances.at(distances.size() * 95 / 100), static_cast<double>(result.count()) * ml,
        static_cast<double>(reference.count()) * ml, components_of(result).sizes.size());
    if (words.size() > 5) write_picture(result, reference, words[4], words[5]);
}

void seeds(const std::vector<std::string>& words) {
    const Mask inside = erode(mask_of(words.at(0), words.at(1)), std::stod(words.at(4)));
    std::vector<std::size_t> offsets;
    for (std::size_t i = 0; i < inside.voxels.size(); ++i)
        if (inside.voxels[i]) offsets.push_back(i);
    std::mt19937 random(static_cast<unsigned>(std::stoul(words.at(3))));
    std::vector<std::string> points;
    const auto row = static_cast<std::size_t>(inside.grid.size[0]),
               slice = row * static_cast<std::size_t>(inside.grid.size[1]);
    for (unsigned long n = 0; n < std::stoul(words.at(2)); ++n) {
        const std::size_t offset = offsets.at(random() % offsets.size());
        const Eigen::Vector3d p = inside.grid.point_of(
            Eigen::Vector3d(static_cast<double>(offset % row), static_cast<double>(offset % slice / row),
                            static_cast<double>(offset / slice)));
        points.push_back(fmt::format("{:.1f},{:.1f},{:.1f}", p[0], p[1], p[2]));
    }
    std::cout << fmt::format("\"{}\"\n", fmt::join(points, ";"));
}

void grow(const std::vector<std::string>& words) {
    const Volume volume = read_volume(words.at(0));
    std::vector<Seed> points;
    for (std::size_t n = 1; n < words.size(); ++n) {
        const auto equals = words[n].find('=');
        Seed seed{words[n].substr(0, equals), {}};
        std::istringstream stream(words[n].substr(equals + 1));
        for (Eigen::Index axis = 0; axis < 3; ++axis) {
            std::string part;
            std::getline(stream, part, ',');
            seed.p_P[axis] = std::stod(part);
        }
        points.push_back(seed);
    }
    const auto timed = [&](const GrowParameters& parameters) {
        const auto start = std::chrono::steady_clock::now();
        const LabelMap map = grow_from_seeds(volume, points, parameters);
        return std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    };
    std::cout << fmt::format("{{\"preview_s\": {:.2f}, \"full_s\": {:.2f}}}\n",
                             timed(preview_parameters(volume.grid)), timed({}));
}

}  // namespace

int main(int argc, char** argv) {
    const std::vector<std::string> words(argv + std::min(argc, 2), argv + argc);
    const std::string task = argc > 1 ? argv[1] : "";
    try {
        if (task == "score")
            score(words);
        else if (task == "seeds")
            seeds(words);
        else if (task == "grow")
            grow(words);
        else
            throw std::out_of_range("score, seeds or grow?");
    } catch (const std::exception& error) {
        std::cerr << "judge_segmentation: " << error.what() << "\n";
        return 1;
    }
}
