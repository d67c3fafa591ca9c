// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/body_io.hpp"

#include <Eigen/Core>
#include <cstring>

#include "formats/asset/hdf5/columns.hpp"
#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/looks_io.hpp"
#include "formats/asset/validate.hpp"
#include "formats/model/errors.hpp"

namespace palpate::asset {
namespace {

constexpr std::int32_t schema = 2;
constexpr auto any = Hdf5File::any;

// Rows of the asset's arrays are the in-memory values, byte for byte.
static_assert(sizeof(Eigen::Vector3d) == 3 * sizeof(double));

template <typename Scalar, typename Row>
// NOLINTNEXTLINE(bugprone-sizeof-expression): a row may be one scalar
constexpr std::size_t width_of = sizeof(Row) / sizeof(Scalar);

template <typename Scalar, typename Row>
void write_rows(Hdf5Writer& writer, const std::string& path, const std::vector<Row>& rows,
                std::string_view unit = "") {
    constexpr std::size_t width = width_of<Scalar, Row>;
    const std::span<const Scalar> values(reinterpret_cast<const Scalar*>(rows.data()), rows.size() * width);
    if constexpr (width == 1)
        writer.dataset(path, values, {rows.size()}, unit);
    else
        writer.dataset(path, values, {rows.size(), width}, unit);
}

// Reads `count` rows, or as many as there are.
template <typename Scalar, typename Row>
std::vector<Row> read_rows(const Hdf5File& file, const std::string& path, std::int64_t count = any) {
    constexpr std::int64_t width = width_of<Scalar, Row>;
    std::vector<std::int64_t> shape{count};
    if (width > 1) shape.push_back(width);
    const std::span<const Scalar> values = file.dataset<Scalar>(path, shape);
    std::vector<Row> rows(values.size() / width);
    if (!rows.empty()) std::memcpy(static_cast<void*>(rows.data()), values.data(), values.size_bytes());
    return rows;
}

void write_labels(Hdf5Writer& writer, const std::string& prefix, const std::vector<Label>& labels) {
    const LabelColumns columns = columns_of(labels);
    write_rows<std::int32_t>(writer, prefix + "_values", columns.values);
    writer.texts(prefix + "_names", columns.names, {columns.names.size()});
    write_rows<float>(writer, prefix + "_colours", columns.colours);
}

std::vector<Label> read_labels(const Hdf5File& file, const std::string& prefix) {
    const auto values = read_rows<std::int32_t, std::int32_t>(file, prefix + "_values");
    const auto count = static_cast<std::int64_t>(values.size());
    const auto names = file.texts(prefix + "_names", {count});
    const auto colours = read_rows<float, std::array<float, 3>>(file, prefix + "_colours", count);
    std::vector<Label> labels;
    for (std::size_t i = 0; i < values.size(); ++i) labels.push_back({values[i], names[i], colours[i]});
    return labels;
}

// Surface vertices are mesh nodes; indices are checked here because copying needs them.
BoundarySurface read_boundary(const Hdf5File& file, const std::string& path, const TetMesh& mesh) {
    BoundarySurface boundary;
    boundary.nodes = read_rows<std::int32_t, std::int32_t>(file, path + "/surface_nodes");
    for (const std::int32_t node : boundary.nodes) {
        if (node < 0 || static_cast<std::size_t>(node) >= mesh.rest_positions.size())
            file.refuse(path + "/surface_nodes", "has index " + std::to_string(node),
                        "0 to " + std::to_string(mesh.rest_positions.size()) + " exclusive");
        boundary.surface.vertices.push_back(mesh.rest_positions[node]);
    }
    boundary.surface.triangles = read_rows<std::int32_t, Triangle>(file, path + "/surface_triangles");
    return boundary;
}

// A file without it means that nothing relaxes.
std::vector<RegionRelaxation> read_relaxation(const Hdf5File& file, const std::string& path) {
    if (!file.contains(path + "/relaxation") && !file.contains(path + "/relaxation_regions")) return {};
    const auto regions = read_rows<std::int32_t, std::int32_t>(file, path + "/relaxation_regions");
    const auto terms = read_rows<double, std::array<double, 2>>(file, path + "/relaxation",
                                                                static_cast<std::int64_t>(regions.size()));
    std::vector<RegionRelaxation> relaxation;
    for (std::size_t i = 0; i < regions.size(); ++i)
        relaxation.push_back({regions[i], {.share = terms[i][0], .time = terms[i][1]}});
    return relaxation;
}

void write_compliance(Hdf5Writer& writer, const std::string& path, const DenseCompliance& compliance) {
    const std::size_t dofs = compliance.dof_count();
    writer.dataset(path + "/dense", std::span(compliance.entries.get(), dofs * dofs), {dofs, dofs}, "mm/N");
}

void write_compliance(Hdf5Writer& writer, const std::string& path, const HierarchicalCompliance& compliance) {
    const BlockColumns columns = columns_of(compliance.blocks);
    writer.attribute(path, "depth", compliance.depth);
    writer.attribute(path, "accuracy", compliance.accuracy);
    write_rows<std::int32_t>(writer, path + "/order", compliance.order);
    write_rows<std::int32_t>(writer, path + "/first_child", columns.first_child);
    write_rows<std::int32_t>(writer, path + "/rank", columns.rank);
    write_rows<std::int64_t>(writer, path + "/block_values", columns.values);
    write_rows<std::int64_t>(writer, path + "/block_factors", columns.factors);
    writer.dataset(path + "/values", std::span(compliance.values.get(), compliance.value_count),
                   {compliance.value_count}, "mm/N");
    writer.dataset(path + "/factors", std::span(compliance.factors.get(), compliance.factor_count),
                   {compliance.factor_count});
}

DenseCompliance map_dense(const Hdf5File& file, const std::string& path, std::size_t node_count) {
    const auto dofs = static_cast<std::int64_t>(3 * node_count);
    const std::span<const float> entries = file.dataset<float>(path + "/dense", {dofs, dofs});
    return {static_cast<std::int32_t>(node_count),
            std::shared_ptr<const float>(file.mapping().owner(), entries.data())};
}

HierarchicalCompliance map_hierarchical(const Hdf5File& file, const std::string& path,
                                        std::size_t node_count) {
    HierarchicalCompliance compliance;
    compliance.node_count = static_cast<std::int32_t>(node_count);
    compliance.depth = file.attribute<std::int32_t>(path, "depth");
    compliance.accuracy = file.attribute<double>(path, "accuracy");
    compliance.order =
        read_rows<std::int32_t, std::int32_t>(file, path + "/order", static_cast<std::int64_t>(node_count));
    const auto first_child = read_rows<std::int32_t, std::int32_t>(file, path + "/first_child");
    const auto count = static_cast<std::int64_t>(first_child.size());
    const auto rank = file.dataset<std::int32_t>(path + "/rank", {count});
    const auto block_values = file.dataset<std::int64_t>(path + "/block_values", {count});
    const auto block_factors = file.dataset<std::int64_t>(path + "/block_factors", {count});
    for (std::size_t b = 0; b < first_child.size(); ++b)
        compliance.blocks.push_back({first_child[b], rank[b], block_values[b], block_factors[b]});
    const auto values = file.dataset<float>(path + "/values", {any});
    compliance.value_count = values.size();
    compliance.values = std::shared_ptr<const float>(file.mapping().owner(), values.data());
    const auto factors = file.dataset<std::int16_t>(path + "/factors", {any});
    compliance.factor_count = factors.size();
    compliance.factors = std::shared_ptr<const std::int16_t>(file.mapping().owner(), factors.data());
    check_hierarchical(compliance, file.name() + ": " + path);  // before positions are made of the order
    compliance.positions.resize(node_count);
    for (std::size_t p = 0; p < node_count; ++p)
        compliance.positions[compliance.order[p]] = static_cast<std::int32_t>(p);
    return compliance;
}

SurfaceCompliance map_compliance(const Hdf5File& file, const std::string& path, std::size_t node_count) {
    const bool dense = file.contains(path + "/dense"), hierarchical = file.contains(path + "/first_child");
    // Nothing says that the two are equal, and readers would differ in which they take.
    if (dense && hierarchical) file.refuse(path, "is both dense and hierarchical", "one of the two");
    if (dense) return map_dense(file, path, node_count);
    if (hierarchical) return map_hierarchical(file, path, node_count);
    file.refuse(path, "is neither dense nor hierarchical", "'dense', or 'first_child' and what goes with it");
}

// Unchecked.
ObbTree obb_tree_from(const Hdf5File& file, const std::string& path) {
    const auto centers = read_rows<float, std::array<float, 3>>(file, path + "/centers");
    const auto count = static_cast<std::int64_t>(centers.size());
    const auto axes = file.dataset<float>(path + "/axes", {count, 3, 3});
    const auto half_extents = read_rows<float, std::array<float, 3>>(file, path + "/half_extents", count);
    const auto first = file.dataset<std::int32_t>(path + "/first", {count});
    const auto counts = file.dataset<std::int32_t>(path + "/count", {count});
    ObbTree tree;
    tree.nodes.resize(centers.size());
    for (std::size_t i = 0; i < centers.size(); ++i) {
        ObbNode& node = tree.nodes[i];
        node.axes = Eigen::Map<const Eigen::Matrix<float, 3, 3, Eigen::RowMajor>>(axes.data() + 9 * i);
        node.center = Eigen::Vector3f(centers[i].data());
        node.half_extents = Eigen::Vector3f(half_extents[i].data());
        node.first = first[i];
        node.count = counts[i];
    }
    tree.triangle_order = read_rows<std::int32_t, std::int32_t>(file, path + "/triangle_order");
    return tree;
}

void require_palpate_group(const Hdf5File& file) {
    if (!file.contains("/palpate"))
        throw InvalidInput({file.name(), "is an HDF5 file, but not one of palpate's", "a group /palpate",
                            "give an asset (.vtkhdf) or a part that palpate wrote"});
}

}  // namespace

void write_header(Hdf5Writer& writer, const std::string& kind) {
    writer.group("/palpate");
    writer.attribute("/palpate", "schema", schema);
    writer.attribute("/palpate", "kind", kind);
    writer.attribute("/palpate", "units", "mm, N, s");
    writer.attribute("/palpate", "space", "LPS");
}

std::string header_kind(const Hdf5File& file) {
    require_palpate_group(file);
    return file.text_attribute("/palpate", "kind");
}

void check_header(const Hdf5File& file, const std::string& kind) {
    require_palpate_group(file);
    const auto found_schema = file.attribute<std::int32_t>("/palpate", "schema");
    if (found_schema > schema)
        throw InvalidInput({file.name(), "has schema " + std::to_string(found_schema),
                            "at most " + std::to_string(schema),
                            "use a newer palpate, or make the file again with this one"});
    if (found_schema != schema)
        throw InvalidInput({file.name(), "has schema " + std::to_string(found_schema), std::to_string(schema),
                            "make the file again with this palpate"});
    const std::string found_kind = header_kind(file);
    if (found_kind != kind)
        throw InvalidInput(
            {file.name(), "is of kind '" + found_kind + "'", "'" + kind + "'",
             "'palpate pack' makes a case (.vtkhdf) of bodies (.body.h5) and OBB trees (.obb.h5)"});
    if (file.text_attribute("/palpate", "units") != "mm, N, s")
        file.refuse("/palpate", "has other units", "mm, N, s");
    if (file.text_attribute("/palpate", "space") != "LPS")
        file.refuse("/palpate", "is in another frame", "LPS");
}

void write_obb_tree(Hdf5Writer& writer, const std::string& path, const ObbTree& tree,
                    const TriangleMesh& surface) {
    const ObbColumns columns = columns_of(tree.nodes);
    writer.group(path);
    writer.attribute(path, "surface_sha256", surface_digest(surface));
    writer.dataset(path + "/axes",
                   std::span(reinterpret_cast<const float*>(columns.axes.data()), 9 * columns.axes.size()),
                   {columns.axes.size(), 3, 3});
    write_rows<float>(writer, path + "/centers", columns.centers, "mm");
    write_rows<float>(writer, path + "/half_extents", columns.half_extents, "mm");
    write_rows<std::int32_t>(writer, path + "/first", columns.first);
    write_rows<std::int32_t>(writer, path + "/count", columns.count);
    write_rows<std::int32_t>(writer, path + "/triangle_order", tree.triangle_order);
}

std::string surface_digest_of_obb_tree(const Hdf5File& file, const std::string& path) {
    return file.text_attribute(path, "surface_sha256");
}

ObbTree read_obb_tree(const Hdf5File& file, const std::string& path, const TriangleMesh& surface) {
    if (surface_digest_of_obb_tree(file, path) != surface_digest(surface))
        throw InvalidInput({file.name() + ": " + path, "was built over another surface", "",
                            "run 'palpate obb' on the surface again"});
    ObbTree tree = obb_tree_from(file, path);
    check_obb_tree(tree, surface.triangles.size(), file.name() + ": " + path);
    check_enclosure(tree, surface, file.name() + ": " + path);
    return tree;
}

ObbTree read_obb_tree(const Hdf5File& file, const std::string& path) {
    ObbTree tree = obb_tree_from(file, path);
    check_obb_tree(tree, tree.triangle_order.size(), file.name() + ": " + path);
    return tree;
}

void write_feel(Hdf5Writer& writer, const std::string& path, const Feel& feel) {
    writer.group(path);
    writer.attribute(path, "tool_radius", feel.tool_radius);
    writer.attribute(path, "depth", feel.depth);
    write_rows<float>(writer, path + "/stiffness", feel.stiffness, "N/mm");
    writer.group(path + "/regions");
    for (std::size_t i = 0; i < feel.regions.size(); ++i) {
        const std::string region = path + "/regions/" + std::to_string(i);
        writer.group(region);
        write_fields(writer, region, felt_region_fields, feel.regions[i]);
    }
}

std::optional<Feel> read_feel(const Hdf5File& file, const std::string& path, const DeformableBody& body) {
    if (!file.contains(path)) return std::nullopt;
    Feel feel{.tool_radius = file.attribute<double>(path, "tool_radius"),
              .depth = file.attribute<double>(path, "depth"),
              .stiffness = read_rows<float, float>(file, path + "/stiffness",
                                                   static_cast<std::int64_t>(body.boundary.nodes.size())),
              .regions = {}};
    for (std::size_t i = 0;; ++i) {
        const std::string region = path + "/regions/" + std::to_string(i);
        if (!file.contains(region)) break;
        read_fields(file, region, felt_region_fields, feel.regions.emplace_back());
    }
    check_feel(feel, body, file.name() + ": " + path);
    return feel;
}

void write_rigid_body(Hdf5Writer& writer, const std::string& path, const RigidBody& body) {
    writer.group(path);
    writer.attribute(path, "name", body.name);
    write_colour(writer, path, body.colour);
    write_rows<double>(writer, path + "/vertices", body.surface.vertices, "mm");
    write_rows<std::int32_t>(writer, path + "/triangles", body.surface.triangles);
    write_obb_tree(writer, path + "/obb_tree", body.obb_tree, body.surface);
}

RigidBody read_rigid_body(const Hdf5File& file, const std::string& path) {
    RigidBody body;
    body.name = file.text_attribute(path, "name");
    check_name(body.name, file.name() + ": " + path);
    body.colour = read_colour(file, path);
    body.surface.vertices = read_rows<double, Eigen::Vector3d>(file, path + "/vertices");
    body.surface.triangles = read_rows<std::int32_t, Triangle>(file, path + "/triangles");
    check_surface(body.surface, file.name() + ": " + path);
    check_sides(body.surface, file.name() + ": " + path);
    body.obb_tree = read_obb_tree(file, path + "/obb_tree", body.surface);
    return body;
}

bool read_large_deformation(const Hdf5File& file, const std::string& path) {
    if (!file.has_attribute(path, "large_deformation")) return false;
    const auto large = file.attribute<std::int32_t>(path, "large_deformation");
    if (large != 0 && large != 1)
        file.refuse(path, "has large_deformation " + std::to_string(large), "0 or 1");
    return large == 1;
}

void write_condensed_body(Hdf5Writer& writer, const std::string& path, const DeformableBody& body,
                          const std::string& mechanics) {
    writer.group(path);
    writer.attribute(path, "name", body.name);
    write_rows<double>(writer, path + "/rest_positions", body.mesh.rest_positions, "mm");
    write_rows<std::int32_t>(writer, path + "/tetrahedra", body.mesh.tetrahedra);
    write_rows<std::int32_t>(writer, path + "/regions", body.mesh.regions);
    write_labels(writer, path + "/region", body.mesh.region_names);
    write_rows<std::int32_t>(writer, path + "/outside_labels", body.mesh.outside_labels);
    write_labels(writer, path + "/outside", body.mesh.outside_names);
    const MaterialColumns materials = columns_of(body.materials);
    write_rows<std::int32_t>(writer, path + "/material_regions", materials.regions);
    write_rows<double>(writer, path + "/materials", materials.values, "N/mm^2, 1");
    if (!body.relaxation.empty()) {
        const RelaxationColumns relaxation = columns_of(body.relaxation);
        write_rows<std::int32_t>(writer, path + "/relaxation_regions", relaxation.regions);
        write_rows<double>(writer, path + "/relaxation", relaxation.values, "1, s");
    }
    write_rows<std::int32_t>(writer, path + "/fixed_nodes", body.fixed_nodes);
    write_rows<std::int32_t>(writer, path + "/surface_nodes", body.boundary.nodes);
    write_rows<std::int32_t>(writer, path + "/surface_triangles", body.boundary.surface.triangles);
    write_rows<std::int32_t>(writer, path + "/contact_nodes", body.contact_nodes);
    write_colour(writer, path, body.colour);
    write_region_colours(writer, path, body.region_colours);

    writer.attribute(path, "element_order", static_cast<std::int32_t>(body.element_order));
    if (body.large_deformation) writer.attribute(path, "large_deformation", std::int32_t{1});
    writer.group(path + "/compliance");
    std::visit([&](const auto& compliance) { write_compliance(writer, path + "/compliance", compliance); },
               body.compliance);
    writer.attribute(path + "/compliance", "mechanics_sha256", mechanics);
    writer.group(path + "/certificate");
    write_fields(writer, path + "/certificate", certificate_fields, body.certificate);
}

DeformableBody read_condensed_body(const Hdf5File& file, const std::string& path) {
    DeformableBody body;
    body.name = file.text_attribute(path, "name");
    body.mesh.rest_positions = read_rows<double, Eigen::Vector3d>(file, path + "/rest_positions");
    body.mesh.tetrahedra = read_rows<std::int32_t, Tetrahedron>(file, path + "/tetrahedra");
    body.mesh.regions = read_rows<std::int32_t, std::int32_t>(file, path + "/regions");
    body.mesh.region_names = read_labels(file, path + "/region");
    body.mesh.outside_labels = read_rows<std::int32_t, std::int32_t>(file, path + "/outside_labels");
    body.mesh.outside_names = read_labels(file, path + "/outside");
    const auto regions = read_rows<std::int32_t, std::int32_t>(file, path + "/material_regions");
    const auto materials = read_rows<double, std::array<double, 2>>(
        file, path + "/materials", static_cast<std::int64_t>(regions.size()));
    for (std::size_t i = 0; i < regions.size(); ++i)
        body.materials.push_back({regions[i], {materials[i][0], materials[i][1]}});
    body.relaxation = read_relaxation(file, path);
    body.fixed_nodes = read_rows<std::int32_t, std::int32_t>(file, path + "/fixed_nodes");
    body.boundary = read_boundary(file, path, body.mesh);
    body.contact_nodes = read_rows<std::int32_t, std::int32_t>(file, path + "/contact_nodes");
    body.colour = read_colour(file, path);
    body.region_colours = read_region_colours(file, path);
    const auto element_order = file.attribute<std::int32_t>(path, "element_order");
    if (element_order != 1 && element_order != 2)
        file.refuse(path, "has element_order " + std::to_string(element_order),
                    "1 (linear) or 2 (quadratic)");
    body.element_order = static_cast<ElementOrder>(element_order);
    body.large_deformation = read_large_deformation(file, path);
    body.compliance = map_compliance(file, path + "/compliance", body.contact_nodes.size());
    read_fields(file, path + "/certificate", certificate_fields, body.certificate);
    if (file.text_attribute(path + "/compliance", "mechanics_sha256") != mechanics_digest(body))
        throw InvalidInput({file.name() + ": " + path + "/compliance",
                            "was condensed from another mesh, material or boundary", "",
                            "run 'palpate condense' on the mesh again"});
    check_body(body, file.name() + ": " + path);
    return body;
}

}  // namespace palpate::asset
