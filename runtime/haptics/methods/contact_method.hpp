// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Geometry>
#include <array>
#include <cstddef>
#include <cstdint>
#include <span>

#include "formats/records/tick_result.hpp"
#include "runtime/haptics/whole_tool/tool_spheres.hpp"

namespace palpate::haptics {

/// Where a tool is in one tick.
struct ContactPose {
    Eigen::Vector3d tip{0, 0, 0};    ///< p_P, mm
    Eigen::Vector3d shaft{0, 0, 0};  ///< unit, from the tip along the shaft, frame P; zero: not known
    Eigen::Quaterniond orientation{0, 0, 0,
                                   0};  ///< R_PT of the tool's frame, its z the shaft; zero: not known
    bool trusted = false;               ///< false: nobody knows where it is; the rest says nothing
    bool jumped = false;                ///< it came from afar by a way that nobody saw: contact starts anew
};

/// How a device holds its tool: as it says, or along its shaft, or upright. Realtime-safe.
inline Eigen::Quaterniond orientation_of(const ContactPose& pose) noexcept {
    if (!pose.orientation.coeffs().isZero(0)) return pose.orientation.normalized();
    if (pose.shaft.isZero(0)) return Eigen::Quaterniond::Identity();
    return Eigen::Quaterniond::FromTwoVectors(Eigen::Vector3d::UnitZ(), pose.shaft);
}

/// The springs from a device to its tool.
struct VirtualCoupling {
    double stiffness = 0;            ///< N/mm
    double torsional_stiffness = 0;  ///< N mm/rad, of a tool that turns by itself
};

/// What a collision loop answers.
enum class Detects {
    nothing,    ///< nothing: it is not needed
    positions,  ///< where the device was in a tick
    forces,     ///< what pressed tissue in a tick
};

/// How contact with a patient's surfaces is found, kept and answered: what differs between the lines of the
/// table in contact_methods.hpp. A HapticModel owns one and adds what is common: faults, limits, what a
/// result says of the device. Everything is allocated on construction. A class that derives from this one
/// defines its destructor, first of its virtual functions, beside its constructor: then nothing that releases
/// memory is in the object files of its tick, which tests/house/tick_imports.py reads.
class ContactMethod {
  public:
    virtual ~ContactMethod() = default;

    /// Forgets all contact. Not beside a running tick or detection.
    virtual void reset() noexcept = 0;

    /// Servo's side, 1 kHz: writes the force on each device before any limit (N, frame P) to `forces`, zero
    /// on entry, for tools at `poses` behind virtual couplings like `coupling`. Appends
    /// contacts to the tools' results and raises their depth, body, residual and status; moves tool_position
    /// from the device to where the tool is, where the method tells the two apart, and where the tool turns
    /// by itself writes tool_orientation and the torque (N mm, about the tip) before any limit; may add
    /// faults. A tool that is not trusted feels nothing and its result stays as it is. As many poses, results
    /// and forces as tools (unchecked). One thread; realtime-safe: no allocation, lock or I/O.
    virtual void tick(std::span<const ContactPose> poses, const VirtualCoupling& coupling,
                      std::span<TickResult> results, std::span<Eigen::Vector3d> forces) noexcept = 0;

    /// What the collision loop has to find beside the ticks.
    virtual Detects detects() const noexcept { return Detects::nothing; }
    /// Collision loop's side, of a method that detects: to be called once a period
    /// (CollisionLoop::period_of()) from one thread, which may be another than tick()'s. No allocation or
    /// lock.
    virtual void detect() noexcept {}
    /// From now on what detect_at() needs of ticks is kept. Allocates; not beside a running tick or
    /// detection.
    virtual void keep_forces() {}
    /// The same as detect() for a given position (p_P, mm) of a given tick, or for its forces where they are
    /// kept, as a replay or a loop that is late has it. Instead of detect().
    virtual void detect_at(const std::array<double, 3>& /*device*/, std::int64_t /*tick*/) noexcept {}

    /// What stands for a tool, where that is spheres, in its frame T.
    virtual std::span<const ToolSphere> spheres() const noexcept { return {}; }

    /// Picture's side, one thread: adds to the displacements of deformable body `soft` (mm, by surface
    /// vertex) what the contacts of the tools' results displace it by beyond its compliance.
    virtual void add_beyond(std::size_t /*soft*/, std::span<const TickResult* const> /*results*/,
                            std::span<Eigen::Vector3f> /*displacements*/) {}
};

}  // namespace palpate::haptics
