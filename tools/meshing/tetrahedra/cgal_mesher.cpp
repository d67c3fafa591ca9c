// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/meshing/tetrahedra/cgal_mesher.hpp"

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

#include "tools/meshing/surfaces/surface_gap.hpp"

namespace palpate::meshing {
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

Eigen::Vector3d position(const Point& p) {
    return {p.x(), p.y(), p.z()};
}

// One member of a SizeField as CGAL asks for it.
class Field {
  public:
    using FT = Kernel::FT;
    using Point_3 = Point;
    using Index = Domain::Index;

    Field(const SizeField& sizes, double LocalSizes::*member) : sizes_(&sizes), member_(member) {}
    double operator()(const Point& p, int, const Index& index) const {
        if (const auto* region = boost::get<Domain::Subdomain_index>(&index))
            return sizes_->at(position(p), *region).*member_;
        const auto& patch = boost::get<Domain::Surface_patch_index>(index);
        return sizes_->at(position(p), patch.first, patch.second).*member_;
    }

  private:
    const SizeField* sizes_;
    double LocalSizes::*member_;
};

Domain make_domain(const SmoothedLabels& labels, double error) {
    const ImageGrid& grid = labels.grid();
    CGAL::Bbox_3 box;
    for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector3d index;
        for (int axis = 0; axis < 3; ++axis) index[axis] = (corner >> axis & 1) ? grid.size[axis] - 1 : 0;
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
            tet[c] = entry->second;
        }
        mesh.tetrahedra.push_back(tet);
        mesh.regions.push_back(complex.subdomain_index(cell));
    }
    return mesh;
}

// A surface triangle of the complex.
struct ComplexFacet {
    std::array<Eigen::Vector3d, 3> corners;
    InterfaceSide side;
};

ComplexFacet describe(const Complex& complex, const Complex::Facet& facet) {
    // The infinite vertex beyond the hull has no position.
    const auto [cell, opposite] = complex.triangulation().is_infinite(facet.first)
                                      ? complex.triangulation().mirror_facet(facet)
                                      : facet;
    ComplexFacet result;
    for (int c = 0; c < 3; ++c)
        result.corners[c] = position(cell->vertex((opposite + 1 + c) % 4)->point().point());
    const auto& [a, b, c] = result.corners;
    result.side.normal = (b - a).cross(c - a).normalized();
    if (result.side.normal.dot(position(cell->vertex(opposite)->point().point()) - a) > 0)
        result.side.normal *= -1;
    result.side.inner = static_cast<std::uint8_t>(complex.subdomain_index(cell));
    result.side.outer = static_cast<std::uint8_t>(complex.subdomain_index(cell->neighbor(opposite)));
    return result;
}

// The distance of a triangle to the labels' surface at its centre and half-way to its corners.
double largest_gap(const SmoothedLabels& labels, const ComplexFacet& facet, double reach) {
    const auto& [a, b, c] = facet.corners;
    const Eigen::Vector3d center = (a + b + c) / 3;
    double largest = 0;
    for (const Eigen::Vector3d& p :
         {center, Eigen::Vector3d(0.5 * (center + a)), Eigen::Vector3d(0.5 * (center + b)),
          Eigen::Vector3d(0.5 * (center + c))})
        largest = std::max(largest, std::abs(surface_gap(labels, facet.side, p, reach).value_or(0)));
    return largest;
}

// Halves the wanted size of triangles that are too far from the surface; tells how many there are.
std::int64_t refine_gaps(const Complex& complex, const SmoothedLabels& labels, double max_gap,
                         SizeField& sizes) {
    std::vector<FineBall> balls;
    for (auto facet = complex.facets_in_complex_begin(); facet != complex.facets_in_complex_end(); ++facet) {
        const ComplexFacet triangle = describe(complex, *facet);
        const auto& [a, b, c] = triangle.corners;
        const Eigen::Vector3d center = (a + b + c) / 3;
        const double radius = std::max({(a - center).norm(), (b - center).norm(), (c - center).norm()});
        const double allowed =
            std::min(max_gap, 2 * sizes.at(center, triangle.side.inner, triangle.side.outer).distance);
        if (largest_gap(labels, triangle, radius) > allowed)
            balls.push_back({center, radius, {.facet = 0.5 * radius}});
    }
    for (const FineBall& ball : balls) sizes.add(ball);
    return static_cast<std::int64_t>(balls.size());
}

}  // namespace

TetMesh mesh_smoothed_labels(const SmoothedLabels& labels, std::span<const SurfaceSeed> seeds,
                             SizeField& sizes, double max_gap, const DelaunayShape& shape,
                             const ProgressCallback& progress) {
    CGAL::get_default_random() = CGAL::Random(0);
    const Domain domain = make_domain(labels, 0.02 * std::min(max_gap, sizes.finest_distance()));
    const Criteria criteria(FacetCriteria(shape.facet_angle_deg, Field(sizes, &LocalSizes::facet),
                                          Field(sizes, &LocalSizes::distance)),
                            CellCriteria(shape.cell_radius_edge, Field(sizes, &LocalSizes::cell)));
    Complex complex;
    insert_seeds(complex, domain, seeds);

    const auto refine = [&] {
        constexpr int max_rounds = 6;
        for (int round = 0; round < max_rounds; ++round) {
            CGAL::refine_mesh_3(complex, domain, criteria, parameters::no_odt(), parameters::no_lloyd(),
                                parameters::no_perturb(), parameters::no_exude());
            if (refine_gaps(complex, labels, max_gap, sizes) == 0) break;
        }
    };
    progress("refine", 0.3);
    refine();
    // A time limit of 0 is none: what a busy machine leaves undone would differ from run to run. CGAL's
    // perturber is left out: lift_flat_tetrahedra() reaches better angles in a tenth of its time.
    progress("optimise", 0.5);
    CGAL::odt_optimize_mesh_3(complex, domain, parameters::time_limit = 0,
                              parameters::max_iteration_number = 10);
    // Optimisation slides nodes off sharp edges and tips.
    refine();
    progress("exude", 0.8);
    CGAL::exude_mesh_3(complex, parameters::time_limit = 0,
                       parameters::sliver_bound = shape.min_dihedral_deg);
    return extract(complex);
}

}  // namespace palpate::meshing
