// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/bodies/enclosed_regions.hpp"

#include <array>
#include <chrono>
#include <vtkProperty.h>

#include "formats/model/regions.hpp"
#include "runtime/visual/readings/felt_text.hpp"
#include "runtime/visual/tissue/tissue_colours.hpp"

namespace palpate::visual {

using Eigen::Vector3f;

EnclosedRegions::EnclosedRegions(const DeformableBody& body, const Eigen::Vector3d& toward_eye,
                                 std::size_t first, vtkRenderer* front)
    : body_(&body), inner_nodes_(std::make_shared<std::optional<elasticity::InnerNodes>>()) {
    // Yellow, reddish purple, bluish green: told apart by colour-blind people too (Okabe, Ito 2008).
    const std::array<Rgb, 3> colours{Rgb(240, 228, 66), Rgb(204, 121, 167), Rgb(0, 158, 115)};
    for (const Label& label : enclosed_regions(body.mesh)) {
        const BoundarySurface outline = surface_of_region(body.mesh, label.value);
        const Rgb& own = colours[(first + regions_.size()) % colours.size()];
        MovingSurface surface(outline.surface, toward_eye);
        auto drawn = actor(surface.data(), chosen_colour(body, label.value).value_or(own));
        drawn->GetProperty()->BackfaceCullingOn();
        drawn->GetProperty()->SetOpacity(0.6);
        drawn->VisibilityOff();
        front->AddActor(drawn);
        regions_.push_back({label, outline.nodes, std::move(surface), drawn});
    }
}

std::vector<std::string> EnclosedRegions::names(std::optional<double> rendered) const {
    std::vector<std::string> names;
    for (const Region& region : regions_) {
        const std::string felt = felt_text(*body_, region.label.value, rendered);
        names.push_back(felt.empty() ? region.label.name : region.label.name + " (" + felt + ")");
    }
    return names;
}

void EnclosedRegions::show(bool on) {
    shown_ = on;
    for (const Region& region : regions_) region.actor->SetVisibility(on);
}

void EnclosedRegions::follow(const std::vector<Vector3f>& displacements) {
    if (!shown_ || regions_.empty()) return;
    if (within_.valid()) {
        if (within_.wait_for(std::chrono::seconds(0)) != std::future_status::ready) return;
        const std::vector<Vector3f> within = within_.get();
        for (Region& region : regions_) {
            std::vector<Vector3f> moved;
            for (const std::int32_t node : region.nodes) moved.push_back(within[node]);
            region.surface.displace(moved);
        }
    }
    if (displacements == followed_) return;
    followed_ = displacements;
    within_ = std::async(std::launch::async, [body = body_, nodes = inner_nodes_, displacements] {
        if (!*nodes) nodes->emplace(*body);
        return (*nodes)->follow(displacements);
    });
}

}  // namespace palpate::visual
