// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <cstdint>
#include <future>
#include <memory>
#include <optional>
#include <string>
#include <vector>
#include <vtkActor.h>
#include <vtkRenderer.h>
#include <vtkSmartPointer.h>

#include "formats/elasticity/inner_nodes.hpp"
#include "formats/model/body.hpp"
#include "runtime/visual/actors.hpp"
#include "runtime/visual/bodies/moving_surface.hpp"

namespace palpate::visual {

/// What a deformable body encloses, such as a tumour: translucent bodies seen through all others, hidden at
/// first, which go with the body's surface as its tissue does. How far is worked out beside the frames, a
/// frame or a few later than the surface.
class EnclosedRegions {
  public:
    /// `body` must outlive it. A region without a colour of its own gets one of three by its number, `first`
    /// and on.
    EnclosedRegions(const DeformableBody& body, const Eigen::Vector3d& toward_eye, std::size_t first,
                    vtkRenderer* front);

    std::size_t count() const { return regions_.size(); }
    /// "tumour (stiffer by 34 %, can be felt)", in the user's language; `rendered`: as of felt_text().
    std::vector<std::string> names(std::optional<double> rendered) const;
    void show(bool on);
    /// Moves what is shown; one displacement (mm) per surface vertex of the body.
    void follow(const std::vector<Eigen::Vector3f>& displacements);

  private:
    struct Region {
        Label label;
        std::vector<std::int32_t> nodes;  // mesh node of each vertex
        MovingSurface surface;
        vtkSmartPointer<vtkActor> actor;
    };

    const DeformableBody* body_;
    std::vector<Region> regions_;
    bool shown_ = false;
    std::shared_ptr<std::optional<elasticity::InnerNodes>> inner_nodes_;
    std::vector<Eigen::Vector3f> followed_;             // the surface's displacements, as last asked for
    std::future<std::vector<Eigen::Vector3f>> within_;  // those of the mesh's nodes, being worked out
};

}  // namespace palpate::visual
