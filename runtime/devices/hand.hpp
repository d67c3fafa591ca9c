// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <string>

#include "runtime/devices/hand_path.hpp"
#include "runtime/realtime/triple_buffer.hpp"

namespace palpate::devices {

/// What a hand wants at one moment.
struct HandWish {
    Eigen::Vector3d position;                    ///< mm, in the frame of the device it holds
    bool holds = true;                           ///< false: it has let go
    Eigen::Quaterniond orientation{0, 0, 0, 0};  ///< of the tool in that frame; zero: not known
    double jaw_angle = -1;                       ///< between a forceps' jaws, rad; negative: not known
};

/// Where a hand that holds a simulated device wants to be.
class Hand {
  public:
    virtual ~Hand() = default;
    virtual std::string name() const = 0;
    /// The wish at `time` (s); times do not fall (unchecked). One thread; realtime-safe.
    virtual HandWish at(double time) noexcept = 0;
};

/// A hand that follows a path.
class ScriptedHand final : public Hand {
  public:
    explicit ScriptedHand(HandPath path) : path_(std::move(path)) {}
    std::string name() const override { return "scripted hand"; }
    HandWish at(double time) noexcept override {
        return {path_.at(time), path_.holds_at(time), path_.orientation_at(time), path_.jaw_angle_at(time)};
    }

  private:
    HandPath path_;
};

/// Where another thread wants a hand, in the frame of the device it holds.
struct HandTarget {
    std::array<double, 3> position;                 ///< mm
    std::array<double, 4> orientation{0, 0, 0, 0};  ///< of the tool, x, y, z, w; zero: as it is
};

/// A hand that another thread guides, from mouse or keyboard: it goes straight to its target and turns there
/// by the shortest way, no faster than a hand. It never lets go.
class GuidedHand final : public Hand {
  public:
    static constexpr double usual_speed = 200;    ///< mm/s
    static constexpr double turning_speed = 1.5;  ///< rad/s; a choice

    /// `start`: where it is first, and wants to be; with a zero orientation nobody knows how the tool is
    /// turned. `max_speed`: mm/s.
    explicit GuidedHand(const HandTarget& start, double max_speed = usual_speed)
        : target_(start),
          position_(start.position.data()),
          orientation_(start.orientation.data()),
          max_speed_(max_speed) {}

    /// Sets where to go. Wait-free; from one thread, which may be another than at()'s.
    void set_target(const HandTarget& target) noexcept { target_.write(target); }

    std::string name() const override { return "guided by mouse and keyboard"; }
    HandWish at(double time) noexcept override;

  private:
    void turn(const Eigen::Quaterniond& target, double seconds) noexcept;

    realtime::TripleBuffer<HandTarget> target_;
    Eigen::Vector3d position_;
    Eigen::Quaterniond orientation_;  // zero: not known
    double last_time_ = 0;
    double max_speed_;
};

}  // namespace palpate::devices
