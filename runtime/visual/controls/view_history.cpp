// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/view_history.hpp"

namespace palpate::visual {

void ViewHistory::keep(vtkCamera* camera, Clock::time_point now) {
    constexpr std::size_t most_views = 50;
    constexpr std::chrono::seconds one_change(1);
    const bool goes_on = !views_.empty() && now - last_ < one_change;
    last_ = now;
    if (goes_on) return;
    if (views_.size() == most_views) views_.erase(views_.begin());
    views_.push_back(vtkSmartPointer<vtkCamera>::New());
    views_.back()->DeepCopy(camera);
}

bool ViewHistory::back(vtkCamera* camera) {
    if (views_.empty()) return false;
    camera->DeepCopy(views_.back());
    views_.pop_back();
    last_ = {};
    return true;
}

}  // namespace palpate::visual
