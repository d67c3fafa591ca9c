// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/draft/case_draft.hpp"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

#include "formats/model/errors.hpp"
#include "tools/draft/anatomy.hpp"
#include "tools/imaging/voxels/mask.hpp"

namespace palpate::draft {
namespace {

using imaging::Mask;

// Of the organs of a TotalSegmentator map, all but plates that 0.1 N moved by a quarter of their extent, held
// at one end, are longer; kidney, spleen and liver are not.
constexpr double most_thicknesses = 4;
constexpr double held_share = 0.12;         // of the organ's surface
constexpr double beside_mm = 10;            // as near as this, a structure is a neighbour
constexpr std::size_t most_neighbours = 5;  // the nearest
constexpr double least_lesion_ml = 0.2;
constexpr double largest_neighbour = 4;  // organ's volumes: larger is no neighbour but what lies around
// A mesh's mean edge over its cell size, the bound of its circumradii, as `palpate mesh` makes them: 0.7 to
// 1.1 of liver, spleen and kidney at 500 to 2000 nodes, more the finer it is.
constexpr double edge_over_cell = 1;

// Face neighbours of a voxel, as steps.
constexpr std::array<std::array<std::int32_t, 3>, 6> faces{
    {{-1, 0, 0}, {1, 0, 0}, {0, -1, 0}, {0, 1, 0}, {0, 0, -1}, {0, 0, 1}}};

// Calls visit(voxel's index, face's axis, label beyond) for every face of the label's voxels.
template <typename Visit>
void for_each_face(const LabelMap& map, std::int32_t label, const Visit& visit) {
    const auto& [ni, nj, nk] = map.grid.size;
    for (std::int32_t k = 0; k < nk; ++k)
        for (std::int32_t j = 0; j < nj; ++j)
            for (std::int32_t i = 0; i < ni; ++i) {
                if (map.labels[map.grid.offset(i, j, k)] != label) continue;
                for (std::size_t face = 0; face < faces.size(); ++face) {
                    const auto& [di, dj, dk] = faces[face];
                    const bool inside = map.grid.contains(i + di, j + dj, k + dk);
                    const std::int32_t beyond =
                        inside ? map.labels[map.grid.offset(i + di, j + dj, k + dk)] : 0;
                    if (beyond != label) visit(Eigen::Vector3d(i, j, k), face / 2, beyond);
                }
            }
}

// The surface of a label's voxels.
struct Outside {
    double area = 0;                      // mm²; faces of voxels have half as much again as what they bound
    std::vector<Eigen::Vector3d> points;  // p_P of the voxels, mm
    std::map<std::int32_t, double> touched;  // part of all faces, by the label beyond
};

Outside outside_of(const LabelMap& map, std::int32_t label) {
    Outside outside;
    const Eigen::Vector3d& h = map.grid.spacing;
    double faces_seen = 0;
    for_each_face(map, label, [&](const Eigen::Vector3d& index, std::size_t axis, std::int32_t beyond) {
        const auto a = static_cast<Eigen::Index>(axis);
        outside.area += h.prod() / h[a] * 2 / 3;
        outside.points.push_back(map.grid.point_of(index));
        outside.touched[beyond] += 1;
        ++faces_seen;
    });
    for (auto& [beyond, part] : outside.touched) part /= faces_seen;
    return outside;
}

std::map<std::int32_t, double> volumes_ml(const LabelMap& map) {
    std::map<std::int32_t, double> volumes;
    for (const std::uint16_t label : map.labels) ++volumes[label];
    for (auto& [label, volume] : volumes) volume *= map.grid.voxel_volume() / 1000;
    return volumes;
}

Label choose_organ(const LabelMap& map, const Wishes& wishes, const std::string& culprit) {
    if (!wishes.organ.empty()) return require_label(map, wishes.organ, culprit);
    const std::vector<OrganChoice> organs = organs_in(map, wishes.approach);
    if (organs.empty())
        throw InvalidInput(
            {culprit, "has no structure that gives way, by the names", "an organ", "name it with --organ"});
    if (organs.front().tissue_known || map.names.size() == 1)
        return require_label(map, organs.front().name, culprit);
    constexpr std::size_t shown = 10;
    std::string names;
    for (std::size_t i = 0; i < std::min(shown, map.names.size()); ++i)
        names += (names.empty() ? "" : ", ") + map.names[i].name;
    if (map.names.size() > shown) names += fmt::format(" and {} more", map.names.size() - shown);
    throw InvalidInput({culprit, "has no organ of known tissue; it has " + names, "",
                        "choose one with --organ, or name them with --label-names"});
}

void keep_largest_piece(LabelMap& map, std::int32_t label) {
    const Mask piece = imaging::keep_largest(imaging::mask_of(map, label));
    for (std::size_t v = 0; v < map.labels.size(); ++v)
        if (map.labels[v] == label && piece.voxels[v] == 0) map.labels[v] = 0;
}

// Beyond the plane across `towards` lies held_share of the surface.
Eigen::Vector3d plane_point(std::vector<Eigen::Vector3d> points, const Eigen::Vector3d& towards) {
    const auto place = points.begin() +
                       static_cast<std::ptrdiff_t>((1 - held_share) * static_cast<double>(points.size() - 1));
    std::ranges::nth_element(points, place, {}, [&](const Eigen::Vector3d& p) { return p.dot(towards); });
    return *place;
}

// Whether an organ goes on from where it is held by many times what it is thick: mm, of a volume in ml and an
// area in mm² (a cylinder's diameter is four times one by the other).
bool is_too_long(const std::vector<Eigen::Vector3d>& points, const Eigen::Vector3d& held_at,
                 const Eigen::Vector3d& towards, double volume_ml, double area) {
    const double thickness = 4 * 1000 * volume_ml / area;
    Eigen::Vector3d held = Eigen::Vector3d::Zero();
    double count = 0, farthest = 0;
    for (const Eigen::Vector3d& point : points)
        if ((point - held_at).dot(towards) >= 0) {
            held += point;
            ++count;
        }
    for (const Eigen::Vector3d& point : points) farthest = std::max(farthest, (point - held / count).norm());
    return farthest > most_thicknesses * thickness;
}

// To a tenth of a millimetre, or to a half where that is less than a tenth of it.
double rounded(double mm) {
    const double steps = mm < 5 ? 10 : 2;
    return std::max(0.5, std::round(steps * mm) / steps);
}

// Labels near the organ, by how much of them is.
std::vector<Label> neighbours_of(const LabelMap& map, const Label& organ, const Wishes& wishes,
                                 std::map<std::int32_t, double>& volumes) {
    const std::vector<float> distance = imaging::distance_to(imaging::mask_of(map, organ.value));
    std::map<std::int32_t, std::size_t> near;
    for (std::size_t v = 0; v < distance.size(); ++v)
        if (map.labels[v] != 0 && distance[v] > 0 && distance[v] <= beside_mm) ++near[map.labels[v]];
    std::vector<Label> found;
    for (const Label& label : map.names) {
        const Part part = anatomy_of(label.name, wishes.approach).part;
        if (near.contains(label.value) && (part == Part::organ || part == Part::bone) &&
            volumes[label.value] <= largest_neighbour * volumes[organ.value])
            found.push_back(label);
    }
    std::ranges::sort(found, std::ranges::greater{}, [&](const Label& label) { return near[label.value]; });
    if (found.size() > most_neighbours) found.resize(most_neighbours);
    return found;
}

// Lesions that lie in the organ, each with cells that fit it.
void add_lesions(CaseDraft& draft, const LabelMap& map, const Label& organ, const Wishes& wishes,
                 std::map<std::int32_t, double>& volumes) {
    for (const Label& label : map.names) {
        const Anatomy anatomy = anatomy_of(label.name, wishes.approach);
        if (anatomy.part != Part::lesion || label.value == organ.value ||
            volumes[label.value] < least_lesion_ml)
            continue;
        const auto touched = outside_of(map, label.value).touched;
        if (const auto part = touched.find(organ.value); part == touched.end() || part->second < 0.5)
            continue;
        const double diameter = std::cbrt(6000 * volumes[label.value] / 3.1416);
        draft.structures.push_back(
            {label.name, fmt::format("a lesion of {:.1f} ml in it", volumes[label.value]), ""});
        draft.regions.push_back(
            {label.name, anatomy.tissue, std::min(draft.cell_size, rounded(diameter / 4))});
    }
}

// The contract takes its limits times the voxels' edge, where that is above 1 mm.
std::string quality_lines(double cell_size, const ImageGrid& grid) {
    const double coarseness = std::max(1.0, std::cbrt(grid.voxel_volume()));
    return fmt::format(
        "# What cells of that size can keep.\n[quality]\nmax_mean_distance_mm = {:.2f}\n"
        "max_p95_distance_mm = {:.2f}\nmax_distance_voxel_diagonals = 2.0\nmax_centroid_distance_mm = 0.1\n",
        std::max(0.25, cell_size / 25 / coarseness), std::max(0.5, cell_size / 10 / coarseness));
}

// A tool that is about as wide as the mesh's edges does not feel them.
double tool_radius_for(double edge) {
    return std::clamp(std::round(edge), 1.0, 5.0);
}

}  // namespace

std::vector<OrganChoice> organs_in(const LabelMap& map, const Eigen::Vector3d& approach) {
    auto volumes = volumes_ml(map);
    std::vector<OrganChoice> organs;
    for (const Label& label : map.names) {
        const Anatomy anatomy = anatomy_of(label.name, approach);
        if (anatomy.part == Part::organ)
            organs.push_back({label.name, volumes[label.value], !anatomy.tissue.empty()});
    }
    std::ranges::stable_sort(organs, std::ranges::greater{}, [](const OrganChoice& organ) {
        return std::pair(organ.tissue_known, organ.volume_ml);
    });
    return organs;
}

double nodes_within(double size_mib) {
    constexpr double bytes_of_pair = 9 * sizeof(float);
    return std::sqrt(size_mib * 1024 * 1024 / bytes_of_pair);
}

CaseDraft draft_case(LabelMap map, const Wishes& wishes, const std::string& culprit) {
    const Label organ = choose_organ(map, wishes, culprit);
    keep_largest_piece(map, organ.value);
    auto volumes = volumes_ml(map);
    const Anatomy anatomy = anatomy_of(organ.name, wishes.approach);
    const Outside outside = outside_of(map, organ.value);
    CaseDraft draft;
    draft.name = organ.name;
    draft.volume_ml = volumes[organ.value];
    draft.area_cm2 = outside.area / 100;
    // Equilateral triangles of edge e have a node for each 0.866 e².
    const double edge = std::sqrt(outside.area / (0.866 * wishes.contact_nodes));
    // What is finer than the voxels is made up.
    draft.cell_size = std::max(rounded(edge / edge_over_cell), rounded(map.grid.spacing.maxCoeff()));
    draft.mesh = fmt::format(
        "# Smaller cells make a finer and a larger asset: half the size, four times the surface nodes.\n"
        "mesh = {{ cell_size_mm = {:g}, facet_distance_mm = {:.2f} }}\n",
        draft.cell_size, draft.cell_size / 9);
    draft.quality = quality_lines(draft.cell_size, map.grid);
    draft.held_towards = anatomy.held_towards;
    draft.held_at = plane_point(outside.points, anatomy.held_towards);
    draft.why_held = anatomy.why_held;
    draft.held_along =
        is_too_long(outside.points, draft.held_at, draft.held_towards, draft.volume_ml, outside.area);
    draft.tool_radius = tool_radius_for(std::max(edge, map.grid.spacing.maxCoeff()));
    add_lesions(draft, map, organ, wishes, volumes);
    draft.structures.push_back(
        {organ.name, fmt::format("{:.0f} ml, {:.0f} cm² of surface", draft.volume_ml, draft.area_cm2), ""});
    draft.regions.insert(draft.regions.begin(), {organ.name, anatomy.tissue, 0});
    for (const Label& neighbour : neighbours_of(map, organ, wishes, volumes)) {
        draft.structures.push_back({neighbour.name, "beside it", ""});
        draft.rigid.push_back({neighbour.name});
    }
    return draft;
}

CaseDraft draft_case(const TetMesh& mesh, const Wishes& wishes, const std::string& name) {
    const Anatomy whole = anatomy_of(name, wishes.approach);
    const BoundarySurface boundary = boundary_surface(mesh);
    CaseDraft draft;
    draft.name = name;
    for (const Label& region : mesh.region_names) {
        const std::string tissue = anatomy_of(region.name, wishes.approach).tissue;
        draft.regions.push_back({region.name, tissue.empty() ? whole.tissue : tissue, 0, region.value});
    }
    double edges = 0, area = 0;
    for (const Triangle& t : boundary.surface.triangles) {
        const auto corner = [&](std::size_t i) {
            return boundary.surface.vertices[static_cast<std::size_t>(t[i])];
        };
        edges += (corner(0) - corner(1)).norm();
        area += (corner(1) - corner(0)).cross(corner(2) - corner(0)).norm() / 2;
    }
    const double edge = edges / static_cast<double>(boundary.surface.triangles.size());
    for (std::size_t t = 0; t < mesh.tetrahedra.size(); ++t) draft.volume_ml += six_volume(mesh, t) / 6000;
    draft.cell_size = edge / edge_over_cell;
    draft.tool_radius = tool_radius_for(edge);
    draft.held_towards = whole.held_towards;
    draft.held_at = plane_point(boundary.surface.vertices, whole.held_towards);
    draft.why_held = whole.why_held;
    draft.held_along =
        is_too_long(boundary.surface.vertices, draft.held_at, draft.held_towards, draft.volume_ml, area);
    return draft;
}

std::string plausible_unit(double extent) {
    constexpr double least_mm = 25;  // of a gland; the largest organs have some 400
    if (extent >= least_mm) return "mm";
    return 10 * extent >= least_mm ? "cm" : "m";
}

}  // namespace palpate::draft
