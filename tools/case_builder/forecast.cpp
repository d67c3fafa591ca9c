// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/forecast.hpp"

#include <algorithm>
#include <cmath>

namespace palpate::case_builder {
namespace {

using Json = nlohmann::ordered_json;

double bytes_of(const std::filesystem::path& path) {
    if (std::filesystem::is_regular_file(path)) return static_cast<double>(std::filesystem::file_size(path));
    double bytes = 0;
    if (std::filesystem::is_directory(path))
        for (const auto& entry : std::filesystem::recursive_directory_iterator(path))
            if (entry.is_regular_file()) bytes += static_cast<double>(entry.file_size());
    return bytes;
}

double bytes_read(const Stage& stage) {
    double bytes = 0;
    for (const std::filesystem::path& input : stage.inputs) bytes += bytes_of(input);
    return bytes;
}

// Of the case's largest image.
double voxels(const StageRunner& runner) {
    double largest = 0;
    for (const char* stage : {"import volume", "import labels"})
        if (const auto record = runner.recorded(stage)) {
            double count = 1;
            for (const Json& size : record->result.at("grid").at("size")) count *= size.get<double>();
            largest = std::max(largest, count);
        }
    return largest;
}

// The dense inverse of the surface and its workspace, the factor of the interior in 3-D: fill of nested
// dissection grows with the 4/3th power of the nodes (A. George, SIAM J. Numer. Anal. 10, 1973).
double condensation(const std::string& body, const StageRunner& runner) {
    const auto mesh = runner.recorded("mesh " + body);
    if (!mesh) return 0;
    const double unknowns = 3 * mesh->result.at("surface_nodes").get<double>();
    return 12 * unknowns * unknowns + 200 * std::pow(mesh->result.at("nodes").get<double>(), 4.0 / 3);
}

}  // namespace

std::int64_t peak_memory_forecast(const Stage& stage, const StageRunner& runner) {
    constexpr double program = 70e6;  // code and libraries
    double bytes = program;
    if (stage.command == "import")
        bytes += 100e6 + 8 * bytes_read(stage);  // files may be compressed
    else if (stage.command == "segment" || stage.command == "surface" || stage.command == "mesh")
        bytes += 100e6 + 40 * voxels(runner);
    else if (stage.command == "condense")
        bytes += condensation(stage.name.substr(stage.name.find(' ') + 1), runner);
    else if (stage.command == "report")
        bytes += 350e6 + 40 * voxels(runner) + bytes_read(stage);
    else
        bytes += 30e6 + 4 * bytes_read(stage) + (stage.request.contains("scan") ? 10 * voxels(runner) : 0);
    return static_cast<std::int64_t>(bytes);
}

}  // namespace palpate::case_builder
