// SPDX-License-Identifier: Apache-2.0
// What a whole tool pushed off by gaps is made of: the surfaces of both sides, and who watches them.
#include <algorithm>

#include "runtime/haptics/cones/cone_watch.hpp"
#include "runtime/haptics/features/feature_watch.hpp"
#include "runtime/haptics/methods/gap_contact.hpp"

namespace palpate::haptics {
namespace {

// So far from a surface a single place gives the largest force before they meet, mm; within bounds that are
// choices.
double reach_from(const HapticSettings& settings, double contact_stiffness) {
    constexpr double least = 0.2, most = 2;
    return std::clamp(settings.max_force / contact_stiffness, least, most);
}

collision::SurfaceFeatures features_of_tool(const Case& patient_case) {
    const TriangleMesh surface = tool_surface(patient_case, GapContact::most_triangles);
    return {surface.vertices, surface.triangles};
}

// As a `Watch` sees tool and bodies: each is a `Surface`.
template <typename Watch, typename Surface>
class WatchedContact final : public GapContact {
  public:
    WatchedContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count,
                   const std::string& method)
        : GapContact(patient_case, bodies, tool_count, method), surface_(tool_) {
        for (const collision::SurfaceFeatures& features : features_) surfaces_.emplace_back(features);
        for (std::size_t t = 0; t < tool_count; ++t)
            watches_.push_back(std::make_unique<Watch>(surface_, surfaces_, reach_));
    }

  private:
    Surface surface_;                // the tool's
    std::vector<Surface> surfaces_;  // of the rigid bodies
};

}  // namespace

GapContact::GapContact(const Case& patient_case, const ContactBodies& bodies, std::size_t tool_count,
                       const std::string& method)
    : WholeToolContact(bodies, whole_tool_settings(patient_case, method), tool_count),
      reach_(reach_from(patient_case.haptics, settings_.contact_stiffness)),
      tool_(features_of_tool(patient_case)) {
    for (const RigidBody& body : patient_case.rigid_bodies)
        features_.emplace_back(body.surface.vertices, body.surface.triangles);
}

GapContact::~GapContact() = default;

std::unique_ptr<ContactMethod> make_cones(const Case& patient_case, const ContactBodies& bodies,
                                          std::size_t tool_count) {
    return std::make_unique<WatchedContact<ConeWatch, collision::NormalConeTree>>(patient_case, bodies,
                                                                                  tool_count, "cones");
}

std::unique_ptr<ContactMethod> make_features(const Case& patient_case, const ContactBodies& bodies,
                                             std::size_t tool_count) {
    return std::make_unique<WatchedContact<FeatureWatch, collision::ConvexPieces>>(patient_case, bodies,
                                                                                   tool_count, "features");
}

}  // namespace palpate::haptics
