// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/cgal_mesher.hpp"

#include <CGAL/Exact_predicates_inexact_constructions_kernel.h>
#include <CGAL/Labeled_mesh_domain_3.h>
#include <CGAL/Mesh_complex_3_in_triangulation_3.h>
#include <CGAL/Mesh_criteria_3.h>
#include <CGAL/Mesh_triangulation_3.h>
#include <CGAL/Random.h>
#include <CGAL/exude_mesh_3.h>
#include <CGAL/odt_optimize_mesh_3.h>
#include <CGAL/refine_mesh_3.h>
#include <algorithm>
#include <boost/variant.hpp>
#include <unordered_map>

#include "formats/model/errors.hpp"

namespace palpate {
namespace {

using Kernel = CGAL::Exact_predicates_inexact_constructions_kernel;
using Domain = CGAL::Labeled_mesh_domain_3<Kernel>;
using Triangulation = CGAL::Mesh_triangulation_3<Domain>::type;
using Complex = CGAL::Mesh_complex_3_in_triangulation_3<Triangulation>;
using Criteria = CGAL::Mesh_criteria_3<Triangulation>;
using FacetCriteria = Criteria::Facet_criteria;
using CellCriteria = Criteria::Cell_criteria;
using Point = Kernel::Point_3;
namespace parameters = CGAL::parameters;

// One of a region's sizes as a field over the domain; an interface takes the smaller of its two sides.
class SizingField {
  public:
    using FT = Kernel::FT;
    using Point_3 = Point;
    using Index = Domain::Index;

    SizingField(std::span<const RegionSizing> sizing, double RegionSizing::*member) {
        for (const RegionSizing& region : sizing) sizes_.push_back(region.*member);
    }
    double operator()(const Point&, int, const Index& index) const {
        if (const auto* region = boost::get<Domain::Subdomain_index>(&index)) return size(*region);
        const auto& patch = boost::get<Domain::Surface_patch_index>(index);
        return std::min(size(patch.first), size(patch.second));
    }

  private:
    double size(int region) const {
        return region == 0 ? std::numeric_limits<double>::max()
                           : sizes_[static_cast<std::size_t>(region) - 1];
    }
    std::vector<double> sizes_;
};

Domain make_domain(const SmoothedLabels& labels, double error) {
    const ImageGrid& grid = labels.grid();
    CGAL::Bbox_3 box;
    for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3d index;
        for (int axis = 0; axis < 3; ++axis)
            index[axis] = (corner >> axis & 1) ? grid.size[static_cast<std::size_t>(axis)] - 1 : 0;
        const Eigen::Vector3d p = grid.point_of(index);
        box += Point(p.x(), p.y(), p.z()).bbox();
    }
    const double diagonal =
        std::sqrt(std::pow(box.xmax() - box.xmin(), 2) + std::pow(box.ymax() - box.ymin(), 2) +
                  std::pow(box.zmax() - box.zmin(), 2));
    return Domain(
        [&labels](const Point& p) {
            return int{labels.region_at({p.x(), p.y(), p.z()})};
        },
        box, parameters::relative_error_bound = error / diagonal);
}

void insert_seeds(Complex& complex, const Domain& domain, std::span<const SurfaceSeed> seeds) {
    Triangulation& triangulation = complex.triangulation();
    const auto weighted = triangulation.geom_traits().construct_weighted_point_3_object();
    for (const SurfaceSeed& seed : seeds) {
        const auto& p = seed.position;
        const auto vertex = triangulation.insert(weighted(Point(p.x(), p.y(), p.z())));
        complex.set_dimension(vertex, 2);
        complex.set_index(vertex, domain.index_from_surface_patch_index({seed.lower, seed.upper}));
    }
}

TetMesh extract(const Complex& complex) {
    TetMesh mesh;
    std::unordered_map<Complex::Vertex_handle, std::int32_t, CGAL::Handle_hash_function> node_of;
    for (auto cell = complex.cells_in_complex_begin(); cell != complex.cells_in_complex_end(); ++cell) {
        Tetrahedron tet;
        for (int c = 0; c < 4; ++c) {
            const auto vertex = cell->vertex(c);
            const auto [entry, added] =
                node_of.try_emplace(vertex, static_cast<std::int32_t>(mesh.rest_positions.size()));
            if (added)
                mesh.rest_positions.emplace_back(vertex->point().x(), vertex->point().y(),
                                                 vertex->point().z());
            tet[static_cast<std::size_t>(c)] = entry->second;
        }
        mesh.tetrahedra.push_back(tet);
        mesh.regions.push_back(complex.subdomain_index(cell));
    }
    return mesh;
}

}  // namespace

TetMesh mesh_smoothed_labels(const SmoothedLabels& labels, std::span<const SurfaceSeed> seeds,
                             std::span<const RegionSizing> region_sizing, const MeshSizing& sizing,
                             const ProgressCallback& progress) {
    CGAL::get_default_random() = CGAL::Random(0);
    double finest = region_sizing.front().facet_distance;
    for (const RegionSizing& region : region_sizing) finest = std::min(finest, region.facet_distance);
    const Domain domain = make_domain(labels, 0.02 * finest);
    const Criteria criteria(
        FacetCriteria(sizing.facet_angle_deg, SizingField(region_sizing, &RegionSizing::facet_size),
                      SizingField(region_sizing, &RegionSizing::facet_distance)),
        CellCriteria(sizing.cell_radius_edge, SizingField(region_sizing, &RegionSizing::cell_size)));
    Complex complex;
    insert_seeds(complex, domain, seeds);

    progress("refine", 0.3);
    CGAL::refine_mesh_3(complex, domain, criteria, parameters::no_odt(), parameters::no_lloyd(),
                        parameters::no_perturb(), parameters::no_exude());
    // A time limit of 0 is none: what a busy machine leaves undone would differ from run to run. CGAL's
    // perturber is left out: lift_flat_tetrahedra() reaches better angles in a tenth of its time.
    progress("optimise", 0.6);
    CGAL::odt_optimize_mesh_3(complex, domain, parameters::time_limit = 0,
                              parameters::max_iteration_number = 10);
    progress("exude", 0.8);
    CGAL::exude_mesh_3(complex, parameters::time_limit = 0,
                       parameters::sliver_bound = sizing.min_dihedral_deg);
    return extract(complex);
}

}  // namespace palpate
