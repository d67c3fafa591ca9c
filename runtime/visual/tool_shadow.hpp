// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <optional>
#include <vtkActor.h>
#include <vtkPoints.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "runtime/visual/drop_mark.hpp"

namespace palpate::visual {

/// The tool's shadow with its rim, and the line along which it would come down.
class ToolShadow {
  public:
    explicit ToolShadow(vtkRenderer* renderer);

    /// `tool`: its centre, p_P, mm.
    void update(const Eigen::Vector3d& tool, const std::optional<DropMark>& mark);
    /// What of the renderer is the shadow.
    std::array<vtkActor*, 2> parts() const { return {shade_, lines_}; }

  private:
    vtkSmartPointer<vtkPoints> points_;  // of ring, foot, tool
    vtkSmartPointer<vtkActor> shade_, lines_;
};

}  // namespace palpate::visual
