// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <span>
#include <vector>
#include <vtkActor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "runtime/visual/tools/other_tool.hpp"

namespace palpate::visual {

/// How tools beside the held one are drawn.
struct OtherToolLook {
    double radius = 1;                                     ///< mm, of every tool
    double max_force = 1;                                  ///< N
    double arrow_length = 1;                               ///< mm, of the largest force
    double shaft_length = 1;                               ///< mm
    Eigen::Vector3d shaft_way = Eigen::Vector3d::UnitX();  ///< unit, where a tool's own is not known
};

/// Tools that nobody holds here, and the held forceps' other jaw: a ball with a shaft each and the arrow of
/// its force. Ghosts are see-through as a sieve is, every other pixel, which costs a software renderer
/// nothing, where blending takes a pass of its own over the window.
class OtherTools {
  public:
    /// `front` is drawn over `renderer`: forces show through whatever covers them.
    OtherTools(const OtherToolLook& look, vtkRenderer* renderer, vtkRenderer* front);

    void update(std::span<const OtherTool> tools);

  private:
    struct Actors {
        OtherTool::Kind kind;
        vtkSmartPointer<vtkActor> ball, shaft, arrow;
    };

    Actors make(OtherTool::Kind kind) const;
    void remove(const Actors& actors);
    void place(const Actors& actors, const OtherTool& tool) const;

    OtherToolLook look_;
    vtkRenderer *renderer_, *front_;
    std::vector<Actors> actors_;
};

}  // namespace palpate::visual
