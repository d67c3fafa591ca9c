// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <optional>
#include <string>
#include <vector>

#include "formats/model/colour.hpp"
#include "formats/model/compliance.hpp"
#include "formats/model/feel.hpp"
#include "formats/model/obb_tree.hpp"
#include "formats/model/scan.hpp"
#include "formats/model/tet_mesh.hpp"
#include "formats/model/triangle_mesh.hpp"
#include "formats/records/certificate.hpp"
#include "formats/records/haptic_settings.hpp"
#include "formats/records/material.hpp"
#include "formats/records/tool_settings.hpp"

namespace palpate {

/// The material of one region of a tetrahedral mesh.
struct RegionMaterial {
    std::int32_t region = 0;  ///< label value as in TetMesh::regions
    Material material;
};

/// A term of the relaxation of one region of a tetrahedral mesh.
struct RegionRelaxation {
    std::int32_t region = 0;  ///< label value as in TetMesh::regions
    RelaxationTerm term;
};

/// Polynomial degree of the displacements within a tetrahedron.
enum class ElementOrder : std::int32_t {
    linear = 1,     ///< 4 nodes
    quadratic = 2,  ///< 10 nodes: the corners and the middles of the edges, which are straight
};

/// A body that does not give way.
struct RigidBody {
    std::string name;
    TriangleMesh surface;
    ObbTree obb_tree;                ///< over `surface`
    std::optional<Colour> colour{};  ///< to be drawn in; without it, what its name suggests
};

/// An elastic body held at its fixed nodes, ready to be touched.
struct DeformableBody {
    std::string name;
    TetMesh mesh;
    /// quadratic: the middle nodes of edges are unknowns that `mesh` does not list. Fixed nodes, contact
    /// nodes and the compliance stay over mesh nodes.
    ElementOrder element_order = ElementOrder::linear;
    std::vector<RegionMaterial> materials;  ///< one per region that occurs in the mesh
    /// By region, then by time, both ascending; a region without a term does not relax.
    std::vector<RegionRelaxation> relaxation;
    std::vector<std::int32_t> fixed_nodes;    ///< mesh nodes with zero displacement, ascending
    BoundarySurface boundary;                 ///< boundary_surface(mesh)
    std::vector<std::int32_t> contact_nodes;  ///< mesh node of each compliance block, ascending: some or
                                              ///< all of the boundary nodes that are not fixed
    SurfaceCompliance compliance;             ///< over contact_nodes
    Certificate certificate;
    ObbTree obb_tree;                ///< over boundary.surface at rest
    std::optional<Feel> feel;        ///< with a case's tool; none of a body that is of no case yet
    std::optional<Colour> colour{};  ///< to be drawn in; without it, what names suggest
    std::vector<RegionColour> region_colours{};  ///< of regions that have their own, ascending
    bool large_deformation = false;              ///< felt as neo-Hookean tissue, unless a run says otherwise
};

/// The relaxation of one region; empty if it does not relax.
inline std::vector<RelaxationTerm> relaxation_of(const DeformableBody& body, std::int32_t region) {
    std::vector<RelaxationTerm> terms;
    for (const RegionRelaxation& entry : body.relaxation)
        if (entry.region == region) terms.push_back(entry.term);
    return terms;
}

/// What a hand holds, where it turns by itself and gives torque.
struct ToolBody {
    /// Closed, in the tool's frame T: origin at the tip's centre, z along the shaft, mm. Empty: the ball or
    /// rod of the case's haptic settings.
    TriangleMesh surface;
    ToolSettings settings;
};

/// Everything a trainer needs to touch one patient.
struct Case {
    std::string name;
    std::vector<RigidBody> rigid_bodies;
    std::vector<DeformableBody> deformable_bodies;
    HapticSettings haptics;
    std::optional<ToolBody>
        tool{};  ///< of no asset: chosen for a run; none: a ball or rod that its device turns
    /// Names of the deformable bodies whose tissue is neo-Hookean in a run; of no asset.
    std::vector<std::string> hyperelastic{};
    std::optional<Scan> scan{};
    std::string
        provenance;  ///< JSON: tool and library versions, options, input digests; no identity, no paths
};

/// Whether what is held has a surface of its own.
inline bool has_instrument(const Case& patient_case) {
    return patient_case.tool && !patient_case.tool->surface.triangles.empty();
}

/// How long the shaft of a tool without a surface of its own is, mm.
inline double rod_length(const Case& patient_case) {
    const bool chosen = patient_case.tool && patient_case.tool->settings.rod_length > 0;
    return chosen ? patient_case.tool->settings.rod_length : patient_case.haptics.shaft_length;
}

/// How far a point of what is held is from its tip's centre at most, along the shaft of a tool without a
/// surface of its own, mm.
inline double tool_length(const Case& patient_case) {
    if (!has_instrument(patient_case)) return rod_length(patient_case);
    double farthest = 0;
    for (const Eigen::Vector3d& vertex : patient_case.tool->surface.vertices)
        farthest = std::max(farthest, vertex.norm());
    return farthest;
}

/// How far what is held goes beyond its tip's centre, against its shaft, mm.
inline double tip_reach(const Case& patient_case) {
    if (!has_instrument(patient_case)) return patient_case.haptics.tool_radius;
    double lowest = 0;
    for (const Eigen::Vector3d& vertex : patient_case.tool->surface.vertices)
        lowest = std::min(lowest, vertex.z());
    return -lowest;
}

}  // namespace palpate
