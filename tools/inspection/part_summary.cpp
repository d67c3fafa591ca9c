// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/inspection/part_summary.hpp"

#include <algorithm>
#include <fmt/format.h>

#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/parts.hpp"
#include "formats/model/errors.hpp"
#include "tools/inspection/asset_summary.hpp"
#include "tools/inspection/text.hpp"
#include "tools/stages/body_result.hpp"

namespace palpate::inspection {
namespace {

using Json = nlohmann::ordered_json;

Summary summary_of_obb_tree(const std::filesystem::path& path) {
    const asset::ObbPart part = asset::read_obb_part(path);
    const auto leaves =
        std::ranges::count_if(part.tree.nodes, [](const ObbNode& node) { return node.count > 0; });
    const Eigen::Vector3d size = 2 * part.tree.nodes.front().half_extents.cast<double>();
    return {.form = "obb_tree",
            .json = {{"boxes", part.tree.nodes.size()},
                     {"leaves", leaves},
                     {"triangles", part.tree.triangle_order.size()},
                     {"root_size_mm", {size.x(), size.y(), size.z()}},
                     {"surface_sha256", part.surface_sha256}},
            .text = aligned(
                {{"OBB tree", fmt::format("{} boxes, {} of them leaves", part.tree.nodes.size(), leaves)},
                 {"over", fmt::format("{} triangles", part.tree.triangle_order.size())},
                 {"root box", lengths(size) + " mm"},
                 {"surface digest", part.surface_sha256.substr(0, 16) + "..."}})};
}

Summary summary_of_body(const std::filesystem::path& path) {
    const DeformableBody body = asset::read_body_part(path);
    const std::string mechanics = asset::mechanics_digest(body);
    const std::string surface = asset::surface_digest(body.boundary.surface);
    Json regions = Json::array();
    add_regions(regions, body);
    Json row = row_of(body);
    row.erase("obb_nodes");  // a part has none yet
    std::vector<std::vector<std::string>> rows{{"region", "tetrahedra", "ml", "kPa", "Poisson's ratio"}};
    for (const Json& region : regions)
        rows.push_back({region["region"], region["tetrahedra"].dump(),
                        fmt::format("{:.3f}", region["volume_ml"].get<double>()),
                        fmt::format("{:g}", region["youngs_modulus_kpa"].get<double>()),
                        fmt::format("{:g}", region["poissons_ratio"].get<double>())});
    const std::string text =
        aligned({{"condensed body", body.name},
                 {"mesh", fmt::format("{} nodes, {} {} tetrahedra", body.mesh.rest_positions.size(),
                                      body.mesh.tetrahedra.size(), stages::name_of(body.element_order))},
                 {"boundary", fmt::format("{} nodes, {} triangles", body.boundary.nodes.size(),
                                          body.boundary.surface.triangles.size())},
                 {"held, touched", fmt::format("{} fixed nodes, {} contact nodes", body.fixed_nodes.size(),
                                               body.contact_nodes.size())},
                 {"compliance", fmt::format("{}, {:.2f} MB", stages::representation_of(body.compliance),
                                            static_cast<double>(value_bytes(body.compliance)) * 1e-6)},
                 {"residual", fmt::format("{:.2g}", body.certificate.residual)},
                 {"surface digest", surface.substr(0, 16) + "..."},
                 {"mechanics digest", mechanics.substr(0, 16) + "..."}}) +
        "\n" + table(rows);
    return {.form = "body",
            .json = {{"body", row},
                     {"regions", regions},
                     {"certificate", certificate_row(body)},
                     {"surface_sha256", surface},
                     {"mechanics_sha256", mechanics}},
            .text = text};
}

}  // namespace

Summary summary_of_hdf5(const std::filesystem::path& path) {
    const std::string kind = asset::kind_of(path);
    if (kind == "obb_tree") return summary_of_obb_tree(path);
    if (kind == "body") return summary_of_body(path);
    return {.form = "", .json = asset_json(path), .text = ""};
}

}  // namespace palpate::inspection
