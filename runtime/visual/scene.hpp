// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <optional>
#include <string>
#include <vector>
#include <vtkActor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "formats/model/body.hpp"
#include "runtime/visual/bodies/enclosed_regions.hpp"
#include "runtime/visual/bodies/rigid_surface.hpp"
#include "runtime/visual/bodies/soft_surface.hpp"
#include "runtime/visual/detail/detail.hpp"
#include "runtime/visual/readings/stiffness_map.hpp"
#include "runtime/visual/sight.hpp"
#include "runtime/visual/tools/other_tools.hpp"
#include "runtime/visual/visual_frame.hpp"

namespace palpate::visual {

/// The patient's bodies, the tool and the force, in frame P.
class Scene {
  public:
    /// `patient_case` must outlive it. `rigid_budget`: triangles that all rigid bodies together may have on
    /// the screen. `jaw_length`: mm, of a forceps, whose other jaw is the first of the other tools; nothing:
    /// no forceps. `front` is drawn
    /// over `renderer`: the force and the device show through whatever covers them.
    Scene(const Case& patient_case, const Sight& sight, std::int64_t rigid_budget,
          std::optional<double> jaw_length, vtkRenderer* renderer, vtkRenderer* front);

    void update(const VisualFrame& frame);
    void show_rigid(bool on);
    /// Draws the tool and its force, or leaves them out where the eye is in it.
    void show_tool(bool on);
    /// What of `renderer` is the tool.
    std::array<vtkActor*, 2> tool_parts() const { return {tool_, shaft_}; }
    /// Shows what deformable bodies enclose, hidden at first; it moves with them.
    void show_regions(bool on);
    /// Their names and what is felt of them, in the user's language; empty where nothing is enclosed.
    /// `rendered`: as of felt_text().
    std::string region_names(std::optional<double> rendered) const;
    /// Colours what deforms by how stiff it is under the tool, with a scale; not at first.
    void show_stiffness(bool on);
    /// Whether anybody knows that of this case.
    bool has_stiffness() const { return !stiffness_.empty(); }
    /// Tells whether a cut may show soft bodies from inside; where none does, their far sides are not drawn.
    void show_inside(bool on);
    /// Shows what the near plane of the renderer's camera cuts of rigid bodies, or not.
    void follow_cut(vtkRenderer* renderer, bool cut);
    /// Draws bodies in that detail.
    void draw(const Detail& detail);
    /// What draws the bodies, rigid and deformable.
    std::vector<vtkActor*> bodies() const;
    /// Sections of rigid bodies, each seen from the eye that follow_cut() was told of.
    std::vector<vtkActor*> sections() const;
    /// Whose far sides a cut shows: sections, and deformable bodies.
    std::vector<vtkActor*> opened() const;

  private:
    void add_rigid(const Case& patient_case, const Sight& sight, std::int64_t budget, vtkRenderer* renderer);
    void add_regions(const Case& patient_case, const Sight& sight, vtkRenderer* front);
    void add_tool(const Case& patient_case, const Sight& sight, vtkRenderer* renderer, vtkRenderer* front);
    void place_tool(const VisualFrame& frame);

    double tool_radius_;         // mm
    double max_force_;           // N
    double arrow_length_;        // mm, of the largest force
    double shaft_length_;        // mm
    Eigen::Vector3d shaft_way_;  // unit, from the tool to the hand
    OtherTools others_;
    StiffnessMap stiffness_;
    std::vector<SoftSurface> soft_;
    std::vector<RigidSurface> rigid_;
    std::vector<EnclosedRegions> regions_;  // of each deformable body
    bool tool_shown_ = true, is_instrument_ = false;
    vtkSmartPointer<vtkActor> tool_, shaft_, device_, arrow_, spring_;
    vtkSmartPointer<vtkActor> handle_;  // of a forceps, from its hinge on
};

}  // namespace palpate::visual
