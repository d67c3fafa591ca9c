// SPDX-License-Identifier: Apache-2.0
#include "formats/model/regions.hpp"

#include <algorithm>
#include <map>

namespace palpate {

std::int32_t main_region(const TetMesh& mesh) {
    std::map<std::int32_t, double> volumes;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) volumes[mesh.regions[t]] += six_volume(mesh, t);
    return std::ranges::max_element(volumes, {}, [](const auto& entry) { return entry.second; })->first;
}

std::string region_name(const TetMesh& mesh, std::int32_t region) {
    const auto found = std::ranges::find(mesh.region_names, region, &Label::value);
    return found != mesh.region_names.end() ? found->name : "label " + std::to_string(region);
}

std::vector<Label> enclosed_regions(const TetMesh& mesh) {
    const std::int32_t main = main_region(mesh);
    std::vector<Label> enclosed;
    for (const Label& label : mesh.region_names)
        if (label.value != main && std::ranges::find(mesh.regions, label.value) != mesh.regions.end())
            enclosed.push_back(label);
    return enclosed;
}

BoundarySurface surface_of_region(const TetMesh& mesh, std::int32_t region) {
    TetMesh part;
    part.rest_positions = mesh.rest_positions;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (mesh.regions[t] == region) part.tetrahedra.push_back(mesh.tetrahedra[t]);
    return boundary_surface(part);
}

std::vector<std::int32_t> nodes_of_region(const TetMesh& mesh, std::int32_t region) {
    std::vector<std::int32_t> nodes;
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t)
        if (mesh.regions[t] == region)
            nodes.insert(nodes.end(), mesh.tetrahedra[t].begin(), mesh.tetrahedra[t].end());
    std::ranges::sort(nodes);
    nodes.erase(std::unique(nodes.begin(), nodes.end()), nodes.end());
    return nodes;
}

}  // namespace palpate
