// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <cstddef>
#include <span>
#include <vector>

#include "formats/records/tick_result.hpp"
#include "runtime/haptics/methods/contact_method.hpp"

namespace palpate::haptics {

/// Watches that contact gives hands no more energy than they gave it, and takes away what would be more. From
/// the tick in which the first tool touches to that in which none does, the work of all forces must not be
/// above what sampling explains,
///     sum F . dx <= sum K |dx| (|dx| / 2 + resolution) + P L |ds|,
/// for a force that is held while the device moves by dx is that of a spring of at most the coupling's
/// stiffness K, half a step late; P L |ds| is what turning a shaft of length L against forces of sum P may
/// have stored, for its torque is not felt; of an instrument |ds| is the angle by which it turns. Where
/// torque is felt, its work T . dphi counts instead, against kappa |dphi| (|dphi| / 2 + resolution / L) of
/// the spring that turns the tool. What is above it is taken back by a damper: the force along the way, then
/// the torque along the turn, becomes less, no further than to zero. Contact that keeps energy never needs
/// it. After Hannaford, Ryu, IEEE Trans. Robotics Autom. 18:1-10 (2002). Realtime-safe but for the
/// constructor.
class PassivityObserver {
  public:
    static constexpr double resolution = 1e-3;  ///< mm: to which contact is solved, and encoders read

    /// Of tools of `length` L, mm.
    PassivityObserver(std::size_t tool_count, double length, bool are_instruments)
        : tools_(tool_count), length_(length), are_instruments_(are_instruments) {}

    void reset() noexcept;

    /// Whether a tool's hand feels its torque; none does until this is called.
    void count_torque(std::size_t tool, bool felt) noexcept { tools_[tool].feels_torque = felt; }

    /// Adds the work of the forces that were held since the last tick. If there was more than there may be,
    /// lowers `forces`, N, along the way on which their tools gave it last, and the results' torques likewise
    /// where they are felt, and adds energy_injected to those results' status.
    void damp(std::span<const ContactPose> poses, const VirtualCoupling& coupling,
              std::span<TickResult> results, std::span<Eigen::Vector3d> forces) noexcept;
    /// Keeps what the tick ends with: forces as they are held from now on, and contacts. After a fault, whose
    /// forces are not those of contact, watches again once no tool touches.
    void hold(std::span<const TickResult> results) noexcept;

  private:
    struct Tool {
        Eigen::Vector3d tip{0, 0, 0}, shaft{0, 0, 0};
        Eigen::Quaterniond orientation{Eigen::Quaterniond::Identity()};
        Eigen::Vector3d way{0, 0, 0};  // the last that was any, mm: coarse encoders do not move in every tick
        Eigen::Vector3d turn{0, 0, 0};    // likewise, rad
        Eigen::Vector3d force{0, 0, 0};   // on the device since the last tick, N
        Eigen::Vector3d torque{0, 0, 0};  // the same, N mm
        double pressed = 0;               // N, sum of contact forces
        bool feels_torque = false;
    };

    double stored_unfelt(const Tool& tool, const ContactPose& now, double angle) const noexcept;
    double excess_of(Tool& tool, const ContactPose& now, const VirtualCoupling& coupling) noexcept;

    std::vector<Tool> tools_;
    double length_;  // mm
    bool are_instruments_;
    double excess_ =
        0;  // of this touch: work on the hands above what there may be, N mm; normally below zero
    bool watching_ = true;
};

}  // namespace palpate::haptics
