// SPDX-License-Identifier: Apache-2.0
// Large deformation, what is allocated before the first tick, and the loop's and the picture's side.
#include <algorithm>

#include "formats/model/errors.hpp"
#include "runtime/haptics/contact/large/large_deformation.hpp"

namespace palpate::haptics {
namespace {

std::vector<std::size_t> hyperelastic_bodies(const Case& patient_case) {
    std::vector<std::size_t> softs;
    const auto& bodies = patient_case.deformable_bodies;
    for (const std::string& name : patient_case.hyperelastic) {
        const auto body = std::ranges::find(bodies, name, &DeformableBody::name);
        if (body == bodies.end()) {
            std::string known;
            for (const DeformableBody& other : bodies)
                known += (known.empty() ? "'" : ", '") + other.name + "'";
            throw InvalidInput({patient_case.name, "no deformable body '" + name + "'",
                                known.empty() ? "none: it has rigid ones alone" : known, ""});
        }
        softs.push_back(static_cast<std::size_t>(body - bodies.begin()));
    }
    std::ranges::sort(softs);
    softs.erase(std::ranges::unique(softs).begin(), softs.end());
    return softs;
}

}  // namespace

LargeDeformation::LargeDeformation(const Case& patient_case, const ContactBodies& bodies)
    : bodies_(bodies),
      softs_(hyperelastic_bodies(patient_case)),
      free_(none(softs_.size())),
      loads_(free_),
      shapes_(rest()),
      drawn_(rest()) {
    for (const std::size_t soft : softs_)
        tissues_.push_back(
            std::make_unique<LargeTissue>(patient_case.deformable_bodies[soft], bodies.deformable[soft]));
}

LargeDeformation::~LargeDeformation() = default;

LargeDeformation::Loads LargeDeformation::none(std::size_t bodies) {
    return {.tick = -1, .of_body = std::vector<Forces>(bodies)};
}

LargeDeformation::Shapes LargeDeformation::rest() const {
    Shapes shapes;
    for (const std::size_t soft : softs_)
        shapes.of_body.emplace_back(bodies_.deformable[soft].vertex_count());
    return shapes;
}

void LargeDeformation::keep_forces() {
    if (any()) past_.assign(remembered, none(softs_.size()));
}

void LargeDeformation::reset(ContactEquilibrium& equilibrium) noexcept {
    for (std::size_t k = 0; k < softs_.size(); ++k) {
        tissues_[k]->reset();
        equilibrium.take_shape(softs_[k], nullptr);
    }
    for (Loads& loads : past_) loads.tick = -1;
    taken_ = answered_ = free_until_ = -1;
    loads_.back().tick = loads_.back().taken = -1;
    loads_.publish();
    for (LargeShape& shape : drawn_.back().of_body) shape.reset(shape.drawn.size());
    drawn_.publish();
    shapes_.refresh();  // what was on its way answers forces that are forgotten
}

void LargeDeformation::answer() noexcept {
    const Loads& loads = loads_.read();
    if (loads.tick > answered_ && loads.taken == answered_) answer(loads);
}

void LargeDeformation::answer_tick(std::int64_t tick) noexcept {
    const Loads& then = past_[static_cast<std::size_t>(tick) % remembered];
    if (then.tick == tick) return answer(then);
    free_.tick = tick;
    answer(free_);
}

void LargeDeformation::answer(const Loads& loads) noexcept {
    answered_ = loads.tick;
    Shapes& shapes = shapes_.back();
    Shapes& drawn = drawn_.back();
    shapes.tick = loads.tick;
    for (std::size_t k = 0; k < softs_.size(); ++k) {
        const Forces& forces = loads.of_body[k];
        tissues_[k]->follow({forces.data(), forces.size()}, shapes.of_body[k]);
        drawn.of_body[k] = shapes.of_body[k];
    }
    shapes_.publish();
    drawn_.publish();
}

void LargeDeformation::add_beyond(std::size_t soft, std::span<const TickResult* const> results,
                                  std::span<Eigen::Vector3f> displacements) {
    const auto found = std::ranges::find(softs_, soft);
    if (found == softs_.end()) return;
    const LargeShape& shape = drawn_.read().of_body[static_cast<std::size_t>(found - softs_.begin())];
    drawn_forces_.clear();
    for (const TickResult* result : results)
        bodies_.deformable[soft].append_forces(result->active_contacts(), drawn_forces_);
    double along = 0;
    for (const SurfaceForce& of : drawn_forces_)
        along += static_cast<double>(of.force.dot(shape.moved[static_cast<std::size_t>(of.vertex)]));
    const auto part = static_cast<float>(shape.part(shape.load_of(along)));
    for (std::size_t v = 0; v < displacements.size(); ++v) displacements[v] += part * shape.drawn[v];
}

}  // namespace palpate::haptics
