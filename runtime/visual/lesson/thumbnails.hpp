// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <utility>
#include <vector>
#include <vtkImageData.h>
#include <vtkNew.h>
#include <vtkRenderWindow.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "runtime/visual/lesson/lesson_scene.hpp"
#include "runtime/visual/lesson/lesson_view.hpp"
#include "runtime/visual/sight.hpp"

namespace palpate::visual {

/// Small pictures of the scene for a page, taken one at a time in the window that is there, unseen, so that
/// no frame waits for all of them.
class Thumbnails {
  public:
    static constexpr int width = 176, height = 99;  ///< pixels in a window of 1280x720

    /// Pictures are taken from the side of the first sight.
    Thumbnails(vtkRenderWindow* window, const Sight& sight);

    /// What pictures show, beside marks: whoever made it adds it here.
    vtkRenderer* renderer() { return renderer_; }
    /// Takes the next picture of a page that is not there yet, if there is one, between two frames of the
    /// window. `scale`: as display_scale(); at another whole number of it all are taken anew.
    void take_next(const LessonPage& page, double scale);
    /// Null until it is taken.
    vtkImageData* picture_of(const LessonPicture& picture) const;

  private:
    void take(const LessonPicture& picture);
    void look_at(const LessonPicture& picture);

    vtkRenderWindow* window_;
    Sight sight_;
    vtkNew<vtkRenderer> renderer_;
    LessonScene marks_;
    int enlarged_ = 0;  // how many pixels of the window's one of 1280x720 has
    std::vector<std::pair<LessonPicture, vtkSmartPointer<vtkImageData>>> taken_;
};

}  // namespace palpate::visual
