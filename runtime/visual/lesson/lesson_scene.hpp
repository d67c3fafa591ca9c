// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <vector>
#include <vtkActor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "runtime/visual/lesson/lesson_view.hpp"

namespace palpate::visual {

/// What an exercise puts into the scene: marks, gates, lines and the hand's way, in frame P.
class LessonScene {
  public:
    explicit LessonScene(vtkRenderer* renderer) : renderer_(renderer) {}

    /// Makes anew what has changed since the last view.
    void update(const LessonView& view);

  private:
    vtkRenderer* renderer_;
    std::vector<LessonMark> marks_;
    std::vector<Eigen::Vector3d> line_, line_done_, path_, outline_;
    std::vector<vtkSmartPointer<vtkActor>> mark_actors_;
    vtkSmartPointer<vtkActor> line_actor_, done_actor_, path_actor_, outline_actor_;
};

}  // namespace palpate::visual
