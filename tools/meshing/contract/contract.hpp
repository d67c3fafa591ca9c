// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/records/quality_contract.hpp"
#include "tools/meshing/contract/fidelity.hpp"
#include "tools/meshing/measures/quality.hpp"

namespace palpate::meshing {

/// One limit of the contract against what was measured; if it is not met, what should be finer: the
/// surroundings of places, else the surface of a region.
struct ContractCheck {
    enum class Bound { at_least, at_most };
    std::string name{};         ///< "min_dihedral_deg", as the limit is called in a case file
    std::string measure{};      ///< what is measured, in words: "the smallest dihedral angle"
    std::int32_t region = 0;    ///< label value; 0: the body
    std::string region_name{};  ///< empty: the body
    double value = 0;
    Bound bound = Bound::at_most;  ///< of the value; where it has a sign, of its size
    double limit = 0;
    std::string unit{};  ///< "degrees", "mm", "%"; empty: a ratio or a number of things
    bool met = false;
    std::optional<Eigen::Vector3d> at = {};    ///< p_P, mm: where the value is
    std::vector<Eigen::Vector3d> places = {};  ///< p_P, mm
    double size = 0;                           ///< mm: of the triangles or tetrahedra at the places
};

/// What a check says, for people: "the Dice coefficient of 'liver'", "5.2° at (1.0, 2.0, 3.0)", "at least
/// 12°".
std::string what_text(const ContractCheck& check);
std::string value_text(const ContractCheck& check);
std::string limit_text(const ContractCheck& check);

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

/// `labels` are those of prepare_domain(), `surfaces` their region_surfaces(). Throws as compare() does.
MeshMeasures measure(const TetMesh& mesh, const RegionLabels& labels, std::span<const TriangleMesh> surfaces);

/// Checks a mesh against the contract. Inverted tetrahedra, non-manifold and open edges of the boundary, and
/// components of which less than half is there never meet it. `mesh` names the regions.
std::vector<ContractCheck> check_shape(const QualityContract& contract, const TetMesh& mesh,
                                       const MeshQuality& quality);
std::vector<ContractCheck> check_fidelity(const QualityContract& contract, const TetMesh& mesh,
                                          const MeshMeasures& measures, const ImageGrid& grid);

/// Those that are not met.
std::vector<ContractCheck> misses(std::span<const ContractCheck> checks);

}  // namespace palpate::meshing
