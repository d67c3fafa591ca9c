// SPDX-License-Identifier: Apache-2.0
#include "runtime/devices/jaws/jaws.hpp"

#include <algorithm>
#include <cmath>
#include <utility>

#include "formats/model/arrays.hpp"

namespace palpate::devices {
namespace {

using namespace realtime;
using Eigen::Quaterniond;
using Eigen::Vector3d;

// What both jaws hang on.
class Handle {
  public:
    Handle(std::shared_ptr<Device> device, const JawSettings& jaws, JawHold hold)
        : device_(std::move(device)), jaws_(jaws), hold_(std::move(hold)), angle_(open_angle(jaws)) {}

    Device& device() const noexcept { return *device_; }

    // The first jaw's.
    void read(double time) noexcept {
        state_ = device_->read(time);
        const double passed = std::clamp(time - std::exchange(time_, time), 0.0, 0.1);
        const bool closes = (state_.buttons & 1U) != 0 || (hold_.closed && hold_.closed->load());
        const double way = closing_speed * passed;
        if (state_.faults & distrusted_position) return;  // nobody sees where they go
        angle_ = state_.jaw_angle >= 0 ? std::min(state_.jaw_angle, open_angle(jaws_))
                 : closes              ? std::max(0.0, angle_ - way)
                                       : std::min(open_angle(jaws_), angle_ + way);
        places_ = jaw_places(vector_of(state_.position), orientation(), jaws_, angle_);
    }
    DeviceState state(std::size_t jaw) const noexcept {
        DeviceState state = state_;
        state.position = array_of(places_[jaw].tip);
        state.shaft = array_of(places_[jaw].shaft);
        state.orientation = {0, 0, 0, 0};
        return state;
    }
    void write(std::size_t jaw, const std::array<double, 3>& force) noexcept {
        forces_[jaw] = vector_of(force);
        if (jaw + 1 == forces_.size()) device_->write({array_of(Vector3d(forces_[0] + forces_[1]))});
    }

  private:
    Quaterniond orientation() const noexcept {
        const Quaterniond told = quaternion_of(state_.orientation);
        if (!told.coeffs().isZero(0)) return told;
        const Vector3d shaft = vector_of(state_.shaft);
        if (shaft.isZero(0)) return hold_.orientation;
        return Quaterniond::FromTwoVectors(hold_.orientation * Vector3d::UnitZ(), shaft) * hold_.orientation;
    }

    std::shared_ptr<Device> device_;
    JawSettings jaws_;
    JawHold hold_;
    DeviceState state_;
    double angle_, time_ = 0;
    std::array<JawPlace, 2> places_{};
    std::array<Vector3d, 2> forces_{Vector3d::Zero(), Vector3d::Zero()};
};

class Jaw final : public Device {
  public:
    Jaw(std::shared_ptr<Handle> handle, std::size_t jaw) : handle_(std::move(handle)), jaw_(jaw) {}

    std::string name() const override { return handle_->device().name(); }
    DeviceLimits limits() const override {
        DeviceLimits limits = handle_->device().limits();
        limits.max_force /= 2;
        limits.max_stiffness /= 2;
        limits.damping /= 2;
        limits.max_torque = limits.max_continuous_torque = 0;  // jaws are not turned by tissue
        limits.max_torsional_stiffness = limits.torsional_damping = 0;
        return limits;
    }
    Calibration calibration() override { return handle_->device().calibration(); }
    void calibrate() override { handle_->device().calibrate(); }
    DeviceState read(double time) noexcept override {
        if (jaw_ == 0) handle_->read(time);
        return handle_->state(jaw_);
    }
    void write(const Wrench& wrench) noexcept override { handle_->write(jaw_, wrench.force); }

  private:
    std::shared_ptr<Handle> handle_;
    std::size_t jaw_;
};

}  // namespace

std::array<JawPlace, 2> jaw_places(const Vector3d& meet, const Quaterniond& orientation,
                                   const JawSettings& jaws, double angle) noexcept {
    const Vector3d aside = orientation * Vector3d::UnitX(), along = orientation * Vector3d::UnitZ();
    const double sine = std::sin(angle / 2), cosine = std::cos(angle / 2);
    std::array<JawPlace, 2> places;
    for (std::size_t jaw = 0; jaw < places.size(); ++jaw) {
        const Vector3d out = jaw == 0 ? aside : Vector3d(-aside);
        const Vector3d hinge = meet + jaws.jaw_length * along + jaws.jaw_radius * out;
        places[jaw].shaft = cosine * along - sine * out;
        places[jaw].tip = hinge - jaws.jaw_length * places[jaw].shaft;
    }
    return places;
}

std::array<std::shared_ptr<Device>, 2> jaws_of(std::shared_ptr<Device> device, const JawSettings& jaws,
                                               JawHold hold) {
    const auto handle = std::make_shared<Handle>(std::move(device), jaws, std::move(hold));
    return {std::make_shared<Jaw>(handle, 0), std::make_shared<Jaw>(handle, 1)};
}

}  // namespace palpate::devices
