// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <vector>
#include <vtkActor.h>
#include <vtkFloatArray.h>
#include <vtkNew.h>
#include <vtkPlane.h>
#include <vtkPoints.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>
#include <vtkUnsignedCharArray.h>

#include "formats/model/body.hpp"
#include "runtime/visual/sight.hpp"
#include "runtime/visual/visual_frame.hpp"

namespace palpate {

/// A deformable body as the eye sees it: its surface moves with the displacements and warms up where they
/// are large; what lies over an enclosed region is tinted with that region's colour.
class SoftSurface {
  public:
    SoftSurface(const DeformableBody& body, vtkRenderer* renderer);

    /// Moves the surface; one displacement (mm) per surface vertex.
    void deform(const std::vector<Eigen::Vector3f>& displacements);

    vtkActor* actor() const { return actor_; }

  private:
    void compute_normals();

    std::vector<Eigen::Vector3f> rest_;
    std::vector<Eigen::Vector3f> rest_colours_;  // 0 ... 255
    std::vector<Triangle> triangles_;
    bool displaced_ = false;
    vtkSmartPointer<vtkPoints> points_;
    vtkSmartPointer<vtkFloatArray> normals_;
    vtkSmartPointer<vtkUnsignedCharArray> colours_;
    vtkSmartPointer<vtkActor> actor_;
};

/// The patient's bodies, the tool and the force, in frame P.
class Scene {
  public:
    /// `rigid_budget`: triangles that all rigid bodies together may have on the screen.
    Scene(const Case& patient_case, const Sight& sight, std::int64_t rigid_budget, vtkRenderer* renderer);

    void update(const VisualFrame& frame);

    /// Cuts all bodies open in front of `point`, as seen from `toward_eye`, or not at all.
    void cut_away(bool on, const Eigen::Vector3d& point, const Eigen::Vector3d& toward_eye);
    void show_rigid(bool on);

  private:
    std::vector<SoftSurface> soft_;
    std::vector<vtkSmartPointer<vtkActor>> rigid_;
    vtkNew<vtkPlane> cut_;
    vtkNew<vtkActor> tool_, shaft_, device_, arrow_;
    Eigen::Vector3d shaft_way_;  // unit, from the tool to the hand
    double shaft_length_;        // mm
    double arrow_length_;        // mm, of the largest force
    double max_force_;           // N
};

}  // namespace palpate
