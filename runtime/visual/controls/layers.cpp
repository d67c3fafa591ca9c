// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/layers.hpp"

#include <utility>

#include "runtime/texts/translated.hpp"

namespace palpate::visual {

using texts::translated;

Layers::Layers(const Case& patient_case, Scene& scene, std::optional<double> rendered, vtkRenderer* renderer,
               vtkRenderer* front)
    : scene_(scene), names_(scene.region_names(rendered)) {
    if (patient_case.scan) scan_.emplace(*patient_case.scan, scene.opened(), renderer, front);
}

std::string Layers::turn_regions() {
    if (names_.empty()) return translated("this case has no enclosed region");
    if (exercising_) return translated("in this exercise they stay hidden");
    scene_.show_regions(regions_shown_ = !regions_shown_);
    return regions_shown_ ? translated("seen through the surface: {}", names_)
                          : translated("{}: hidden", names_);
}

std::string Layers::turn_stiffness() {
    if (!scene_.has_stiffness()) return translated("how stiff this case feels is not known: build it again");
    if (exercising_) return translated("in this exercise it stays hidden");
    scene_.show_stiffness(stiffness_shown_ = !stiffness_shown_);
    return stiffness_shown_ ? translated("how stiff each body is under the case's ball, pressed by itself")
                            : "";
}

std::string Layers::turn_slices() {
    if (!scan_) return translated("this case has no scan");
    if (exercising_) return translated("in this exercise it stays hidden");
    scan_->turn();
    return "";
}

void Layers::follow(const VisualFrame& frame, bool cut) {
    exercising_ = frame.lesson.hides_regions;
    if (exercising_ && std::exchange(regions_shown_, false)) scene_.show_regions(false);
    if ((exercising_ || frame.lesson.page) && std::exchange(stiffness_shown_, false))
        scene_.show_stiffness(false);
    if (!scan_) return;
    if (exercising_)
        scan_->hide();
    else
        scan_->follow(frame.tool_position, cut);
}

}  // namespace palpate::visual
