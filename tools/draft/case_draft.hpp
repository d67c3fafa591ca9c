// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <string>
#include <vector>

#include "formats/model/label_map.hpp"
#include "formats/model/tet_mesh.hpp"

namespace palpate::draft {

/// A structure of the case to be.
struct DraftStructure {
    std::string name;
    std::string why;     ///< one clause
    std::string recipe;  ///< its lines of TOML
};

/// A region of the deformable body.
struct DraftRegion {
    std::string label;
    std::string tissue;            ///< a preset; empty: none is known
    double cell_size = 0;          ///< mm; 0: the body's
    std::int32_t mesh_region = 0;  ///< its value in an imported mesh; 0: it comes from a label
};

/// A body that does not give way.
struct DraftRigid {
    std::string label;
    bool by_grey_values = false;  ///< its surface is that of bone in the CT, finer than the label's
};

/// A case file before it is written.
struct CaseDraft {
    std::string name;
    std::string input;    ///< the lines under [input]; empty: there are none
    std::string mesh;     ///< the lines of the body's mesh
    std::string quality;  ///< the lines under [quality]
    std::vector<DraftStructure> structures;
    std::vector<DraftRigid> rigid;
    std::vector<DraftRegion> regions;
    Eigen::Vector3d held_at =
        Eigen::Vector3d::Zero();  ///< p_P, mm: on the plane beyond which the body is held
    Eigen::Vector3d held_towards = Eigen::Vector3d::Zero();  ///< unit
    bool held_along = false;  ///< by all that looks that way, for what is too long to be held at one end
    std::vector<std::string>
        held_by;  ///< labels that it is grown to, in place of that plane; empty: the plane
    std::string why_held;
    double volume_ml = 0, area_cm2 = 0;
    double cell_size = 0;    ///< mm
    double tool_radius = 0;  ///< mm
};

/// What the person may decide.
struct Wishes {
    std::string organ;  ///< a label; empty: the largest structure that gives way, of known tissue first
    Eigen::Vector3d approach{0, -1, 0};  ///< unit, LPS: from the tissue to the surgeon
    double contact_nodes = 2000;         ///< surface nodes that the mesh should have, about
};

/// A structure of a label map that gives way, by its name.
struct OrganChoice {
    std::string name;
    double volume_ml = 0;
    bool tissue_known = false;  ///< by a preset
};

/// Those of a map, the one first that is meant where none is named: the largest of known tissue.
std::vector<OrganChoice> organs_in(const LabelMap& map, const Eigen::Vector3d& approach);

/// Surface nodes whose compliance, the most of an asset, takes so many MiB: 36 bytes a pair.
double nodes_within(double size_mib);

/// Drafts a case from a label map: the largest piece of the organ with its lesions, its neighbours, what
/// holds it, and how fine the mesh is to be. Structures have no recipe yet; lesions come before the organ, so
/// that it may close over what is not theirs. Throws InvalidInput naming `culprit` if the organ is no label
/// of the map (with the nearest names), or if none gives way.
CaseDraft draft_case(LabelMap map, const Wishes& wishes, const std::string& culprit);

/// Drafts a case from tetrahedra that somebody made elsewhere, in mm, without its line mesh_file. A name that
/// says nothing of a region leaves the tissue to that of `name`, the file's.
CaseDraft draft_case(const TetMesh& mesh, const Wishes& wishes, const std::string& name);

/// The unit in which a body of that largest extent (in the file's numbers) is as large as organs are: "mm",
/// "cm" or "m".
std::string plausible_unit(double extent);

/// Writes the draft as a case file with comments.
std::string case_text(const CaseDraft& draft);

}  // namespace palpate::draft
