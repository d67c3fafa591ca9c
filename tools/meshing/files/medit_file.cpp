// SPDX-License-Identifier: GPL-3.0-or-later
#include <fmt/format.h>
#include <set>

#include "tools/meshing/files/found_mesh.hpp"
#include "tools/meshing/files/scanner.hpp"

namespace palpate::meshing {
namespace {

struct Kind {
    const char* name;
    int corners;
    bool solid;
};

const std::map<std::string_view, Kind> kinds{{"Edges", {"edge", 2, false}},
                                             {"Triangles", {"triangle", 3, false}},
                                             {"Quadrilaterals", {"quadrilateral", 4, false}},
                                             {"Hexahedra", {"hexahedron", 8, true}},
                                             {"Prisms", {"prism", 6, true}},
                                             {"Pyramids", {"pyramid", 5, true}},
                                             {"TetrahedraP2", {"second-order tetrahedron", 10, true}}};

bool is_keyword(std::string_view word) {
    return !word.empty() && ((word[0] >= 'A' && word[0] <= 'Z') || (word[0] >= 'a' && word[0] <= 'z'));
}

}  // namespace

FoundTetrahedra read_medit(const std::filesystem::path& path) {
    Scanner file(path);
    if (file.peek() != "MeshVersionFormatted")
        file.fail("does not begin with MeshVersionFormatted", "a MEDIT mesh in ASCII",
                  "binary .meshb files: save as .mesh");
    FoundTetrahedra found;
    found.regions_from = "MEDIT references";
    std::set<std::string_view> seen;
    while (!file.at_end()) {
        const std::string_view keyword = file.word();
        if (keyword == "End") break;
        if (is_keyword(keyword) && !seen.insert(keyword).second)
            file.fail(fmt::format("a second section {}", keyword), "one", "join the two");
        if (keyword.starts_with('#')) {
            file.line();
        } else if (keyword == "Dimension") {
            if (const auto dimension = file.integer(); dimension != 3)
                file.fail(fmt::format("Dimension {}", dimension), "3");
        } else if (keyword == "Vertices") {
            found.points.resize(file.count());
            for (Eigen::Vector3d& p : found.points) {
                for (double& x : p) x = file.number();
                file.word();  // the vertex's own reference
            }
        } else if (keyword == "Tetrahedra") {
            found.tetrahedra.resize(file.count());
            for (Tetrahedron& tet : found.tetrahedra) {
                for (std::int32_t& node : tet) {
                    const std::int64_t vertex = file.integer();
                    if (vertex < 1 || vertex > static_cast<std::int64_t>(found.points.size()))
                        file.fail(fmt::format("a tetrahedron names vertex {}", vertex),
                                  fmt::format("1 ... {}", found.points.size()), "write the file again");
                    node = static_cast<std::int32_t>(vertex - 1);
                }
                found.regions.push_back(file.narrow(file.integer(), "reference"));
            }
        } else {
            // Everything else (triangles, ridges, normals, ...) is numbers up to the next keyword; the number
            // of entries is not relied on, because TetGen announces too many triangles.
            std::int64_t numbers = -1;  // the first one is that number
            for (; !file.at_end() && !is_keyword(file.peek()) && file.peek()[0] != '#'; ++numbers)
                file.word();
            if (const auto kind = kinds.find(keyword); kind != kinds.end() && numbers > 0)
                (kind->second.solid ? found.solid : found.flat)[kind->second.name] +=
                    numbers / (kind->second.corners + 1);
        }
    }
    return found;
}

}  // namespace palpate::meshing
