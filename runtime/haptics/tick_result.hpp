// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

#include "runtime/realtime/fault.hpp"

namespace palpate {

/// Most contact points of one tick; more set TickStatus::contacts_cut.
inline constexpr std::size_t max_contacts = 64;

/// What was unusual about a tick's contacts and force; flags add up. Faults, which take the force away, are
/// told apart.
enum TickStatus : std::uint32_t {
    tick_ok = 0,
    force_limited = 1U << 0,     ///< cut to HapticSettings::max_force
    rate_limited = 1U << 1,      ///< cut to HapticSettings::max_force_rate
    contacts_cut = 1U << 2,      ///< more contact points than max_contacts: the shallowest were left out
    contact_unsolved = 1U << 3,  ///< contacts contradict each other, as in a wedge: no body gave way
    starts_inside = 1U << 4,     ///< a body is not felt until the tool has been clear of it once
    coming_back = 1U << 5,       ///< after a fault, the force returns by and by
};

/// Names the flags of a status, separated by '+', "ok" for none.
std::string status_text(std::uint32_t status);

/// One contact point, with all that is needed to compute its force again offline.
struct Contact {
    std::int32_t body = 0;      ///< 0 ... HapticModel::body_count() - 1: rigid bodies first
    std::int32_t part = 0;      ///< of the tool: 0 the tip, then along its shaft
    std::int32_t triangle = 0;  ///< of the body's surface; -1 if the point is a vertex
    std::array<std::int32_t, 3> vertices{-1, -1, -1};  ///< of the body's surface; -1: unused
    std::array<float, 3> weights{0, 0, 0};             ///< the point is the weighted sum of the vertices
    std::array<float, 3> normal{0, 0, 0};              ///< n: unit, from tissue to tool
    float gap = 0;    ///< delta, mm: how far the point must give way along -n
    float force = 0;  ///< f >= 0, N: the tool pushes the tissue by -n f, the tissue the tool by n f
    float series_compliance = 0;             ///< c, mm/N, in series with the body's own at this point
    std::array<float, 3> friction{0, 0, 0};  ///< on the tool, N; the opposite on the tissue
};

/// The contact's unit normal, from tissue to tool.
inline Eigen::Vector3d normal_of(const Contact& contact) noexcept {
    return Eigen::Map<const Eigen::Vector3f>(contact.normal.data()).cast<double>();
}

/// What the contact does to the tool, N.
inline Eigen::Vector3d force_on_tool(const Contact& contact) noexcept {
    return static_cast<double>(contact.force) * normal_of(contact) +
           Eigen::Map<const Eigen::Vector3f>(contact.friction.data()).cast<double>();
}

/// What one tick saw and did with one tool. Plain bytes: crosses threads and goes to disk as it is.
struct TickResult {
    std::int64_t tick = 0;                           ///< 0 for the first
    std::int32_t tool = 0;                           ///< which one, from 0 on
    double time = 0;                                 ///< s since the loop started
    std::array<double, 3> device_position{0, 0, 0};  ///< p_P, mm
    std::array<double, 3> shaft{0, 0, 0};            ///< as in DeviceState, frame P
    std::array<double, 3> tool_position{0, 0, 0};    ///< at the other end of the virtual coupling; p_P, mm
    std::array<double, 3> force{0, 0, 0};            ///< on the device, frame P, N
    double depth = 0;     ///< of the device below the deepest touched rest surface, mm
    double residual = 0;  ///< worst violation of the contact conditions, mm
    std::int64_t detected_tick =
        -1;                  ///< published schemes: whose position a detection that came in this tick is of
    std::int32_t body = -1;  ///< the deepest touched body, -1 for none
    std::int32_t contact_count = 0;
    std::uint32_t status = tick_ok;              ///< TickStatus flags
    std::uint32_t faults = no_fault;             ///< Fault flags: the force is on its way to zero, or there
    std::uint32_t buttons = 0;                   ///< as in DeviceState
    std::uint32_t overruns = 0;                  ///< periods skipped so far
    std::int64_t tick_ns = 0;                    ///< read, contact, force, write
    std::int64_t wake_latency_ns = 0;            ///< woken this long after the deadline
    std::array<Contact, max_contacts> contacts;  ///< the first contact_count are valid

    std::span<const Contact> active_contacts() const noexcept {
        return {contacts.data(), static_cast<std::size_t>(contact_count)};
    }
};
static_assert(std::is_trivially_copyable_v<TickResult>);

}  // namespace palpate
