// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <span>
#include <string>
#include <vector>

#include "formats/records/quality_contract.hpp"
#include "tools/meshing/contract/fidelity.hpp"
#include "tools/meshing/measures/quality.hpp"

namespace palpate {

/// One limit of the contract against what was measured; if it is not kept, what should be finer: the
/// surroundings of places, else the surface of a region.
struct ContractCheck {
    std::string what, found, limit;  ///< as a sentence would say them: "<what> is <found>"
    bool kept = false;
    std::int32_t region = 0;                   ///< label value; 0: all regions
    std::vector<Eigen::Vector3d> places = {};  ///< p_P, mm
    double size = 0;                           ///< mm: of the triangles or tetrahedra at the places
};

/// A connected piece of a label and how much of it is in the mesh.
struct ComponentCover {
    std::int32_t region = 0;                             ///< label value
    double volume = 0;                                   ///< mm³
    Eigen::Vector3d centroid = Eigen::Vector3d::Zero();  ///< p_P, mm
    double covered = 0;  ///< fraction of its voxels whose centres lie in tetrahedra of its region
};

/// All that is measured of a mesh made from labels.
struct MeshMeasures {
    MeshQuality quality;
    BodyFidelity fidelity;
    std::vector<RegionDistance> distances;
    std::vector<ComponentCover> components;
};

/// Returns the name of a mesh's region, or "label <value>".
std::string region_name(const TetMesh& mesh, std::int32_t region);

/// `labels` are those of prepare_domain(), `surfaces` their region_surfaces(). Throws as compare() does.
MeshMeasures measure(const TetMesh& mesh, const RegionLabels& labels, std::span<const TriangleMesh> surfaces);

/// Checks a mesh against the contract. Inverted tetrahedra, non-manifold and open edges of the boundary, and
/// components of which less than half is there never keep it. `mesh` names the regions and places.
std::vector<ContractCheck> check_shape(const QualityContract& contract, const TetMesh& mesh,
                                       const MeshQuality& quality);
std::vector<ContractCheck> check_fidelity(const QualityContract& contract, const TetMesh& mesh,
                                          const MeshMeasures& measures, const ImageGrid& grid);

/// Those that are not kept.
std::vector<ContractCheck> misses(std::span<const ContractCheck> checks);

}  // namespace palpate
