// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <vector>
#include <vtkCamera.h>
#include <vtkSmartPointer.h>

namespace palpate::visual {

/// The views that a user has left, so that he can go back to them.
class ViewHistory {
  public:
    using Clock = std::chrono::steady_clock;

    /// Keeps the view that is about to be changed. Changes within a second of the last one, as by the notches
    /// of a wheel, count as one. The oldest of more than fifty is forgotten.
    void keep(vtkCamera* camera, Clock::time_point now);
    /// Puts the camera back to the view kept last and forgets that; false if there is none.
    bool back(vtkCamera* camera);

  private:
    std::vector<vtkSmartPointer<vtkCamera>> views_;
    Clock::time_point last_{};
};

}  // namespace palpate::visual
