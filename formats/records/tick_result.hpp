// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <Eigen/Core>
#include <algorithm>
#include <array>
#include <cstdint>
#include <span>
#include <string>
#include <type_traits>

#include "formats/records/eigen_layout.hpp"
#include "formats/records/fault.hpp"
#include "formats/records/field.hpp"

namespace palpate {

inline constexpr double tick_period = 1e-3;  ///< s

/// Most contact points of one tick; more set TickStatus::contacts_cut.
inline constexpr std::size_t max_contacts = 64;

/// What was unusual about a tick's contacts and force; flags add up. Faults, which take the force away, are
/// told apart.
enum TickStatus : std::uint32_t {
    tick_ok = 0,
    force_limited = 1U << 0,  ///< cut to HapticSettings::max_force
    rate_limited = 1U << 1,   ///< cut to HapticSettings::max_force_rate
    contacts_cut = 1U << 2,  ///< more contact points than max_contacts: those that matter least were left out
    contact_unsolved = 1U << 3,   ///< contacts contradict each other, as in a wedge: no body gave way
    starts_inside = 1U << 4,      ///< a body is not felt until the tool has been clear of it once
    coming_back = 1U << 5,        ///< after a fault, the force returns by and by
    energy_injected = 1U << 6,    ///< contact gave more energy than it got: a damper takes it back
    contact_unsettled = 1U << 7,  ///< the search for an equilibrium ended on its way, as where tissue snaps
    large_unsettled = 1U << 8,    ///< tissue that is deformed far was answered late, or was not at rest yet
};

/// How many flags there are.
inline constexpr std::size_t status_count = 9;

/// What is said of a flag of TickStatus.
struct StatusText {
    TickStatus status;
    const char* name;     ///< "contacts_cut"
    const char* meaning;  ///< what it says of the tick
    bool told;            ///< whether a user must know; others are ordinary, or told as a fault
};

/// Every flag, in their order.
std::span<const StatusText, status_count> status_texts();

/// Names the flags of a status, separated by '+', "ok" for none.
std::string status_text(std::uint32_t status);

/// One contact point, with all that is needed to compute its force again offline.
struct Contact {
    std::int32_t body = 0;
    std::int32_t part = 0;
    std::int32_t other_body = -1;
    std::int32_t other_vertex = -1;
    std::int32_t triangle = 0;
    std::array<std::int32_t, 3> vertices{-1, -1, -1};
    std::array<float, 3> weights{0, 0, 0};
    std::array<float, 3> normal{0, 0, 0};
    float gap = 0;                           // mm
    float force = 0;                         // N
    float series_compliance = 0;             // mm/N
    std::array<float, 3> friction{0, 0, 0};  // N
};

inline constexpr std::tuple contact_fields{
    Field("body", &Contact::body, "", "0 to the number of bodies - 1, rigid bodies first"),
    Field("part", &Contact::part, "",
          "of the tool: 0 the tip, then along its shaft, or of an instrument which of its spheres, points or "
          "triangles, as the scheme has it (`solid`: once long edges are halved); -1: another body presses "
          "in the tool's place"),
    Field("other_body", &Contact::other_body, "", "that body; -1: the tool presses").since(1, -1),
    Field("other_vertex", &Contact::other_vertex, "",
          "of that body's surface, which presses; -1: the tool does")
        .since(1, -1),
    Field("triangle", &Contact::triangle, "", "of the body's surface; -1 if the point is a vertex"),
    Field("vertices", &Contact::vertices, "", "of the body's surface; -1: unused"),
    Field("weights", &Contact::weights, "", "the point is the weighted sum of the vertices"),
    Field("normal", &Contact::normal, "", "n: unit, from tissue to what presses it"),
    Field("gap", &Contact::gap, "mm", "delta: how far the point must give way along -n"),
    Field("force", &Contact::force, "N",
          "f >= 0: what presses pushes the tissue by -n f, the tissue pushes back by n f"),
    Field("series_compliance", &Contact::series_compliance, "mm/N",
          "c, in series with the body's own at this point: what the tool sinks in locally, of the part that "
          "gives way"),
    Field("friction", &Contact::friction, "N", "on the tool; the opposite on the tissue")};

/// The contact's unit normal, from tissue to what presses it.
inline Eigen::Vector3d normal_of(const Contact& contact) noexcept {
    return Eigen::Map<const Eigen::Vector3f>(contact.normal.data()).cast<double>();
}

/// Whether a body beside it presses the tissue, and not the tool.
inline bool is_of_neighbour(const Contact& contact) noexcept {
    return contact.other_body >= 0;
}

/// What the contact does to what presses the tissue, N.
inline Eigen::Vector3d reaction_of(const Contact& contact) noexcept {
    return static_cast<double>(contact.force) * normal_of(contact) +
           Eigen::Map<const Eigen::Vector3f>(contact.friction.data()).cast<double>();
}

/// What the contact does to the tool, N: nothing if a body beside it presses.
inline Eigen::Vector3d force_on_tool(const Contact& contact) noexcept {
    return is_of_neighbour(contact) ? Eigen::Vector3d(0, 0, 0) : reaction_of(contact);
}

/// What one tick saw and did with one tool, and when. Positions and forces in frame P.
struct Tick {
    std::int64_t tick = 0;
    std::int32_t tool = 0;
    double time = 0;                                 // s
    std::array<double, 3> device_position{0, 0, 0};  // mm
    std::array<double, 3> shaft{0, 0, 0};
    std::array<double, 4> orientation{0, 0, 0, 0};
    std::array<double, 3> tool_position{0, 0, 0};  // mm
    std::array<double, 4> tool_orientation{0, 0, 0, 0};
    std::array<double, 3> force{0, 0, 0};   // N
    std::array<double, 3> torque{0, 0, 0};  // N mm
    double depth = 0;                       // mm
    double residual = 0;                    // mm
    std::int64_t detected_tick = -1;
    std::int32_t body = -1;
    std::int32_t contact_count = 0;
    std::uint32_t status = tick_ok;
    std::uint32_t faults = no_fault;
    std::uint32_t buttons = 0;
    std::uint32_t overruns = 0;
    std::int64_t tick_ns = 0;
    std::int64_t wake_latency_ns = 0;
    std::int64_t first_contact = 0;  // of a recording, set by its writer
};

inline constexpr std::tuple tick_fields{
    Field("tick", &Tick::tick, "", "0 for the run's first"),
    Field("tool", &Tick::tool, "", "which one, from 0 on"),
    Field("time", &Tick::time, "s", "since the loop started"),
    Field("device_position", &Tick::device_position, "mm", "of the tool's centre as the device has it"),
    Field("shaft", &Tick::shaft, "", "unit vector from the tip along the tool's shaft; zero: not known"),
    Field("orientation", &Tick::orientation, "",
          "of the tool as the device has it: unit quaternion x, y, z, w that turns the tool's frame, whose z "
          "is the shaft, to the patient's; zero: not known")
        .since(1, {0, 0, 0, 0}),
    Field("buttons", &Tick::buttons, "", "one bit each, the lowest for the first").stored_as<std::int64_t>(),
    Field("faults", &Tick::faults, "",
          "flags of formats/records/fault.hpp: the force is on its way to zero, or there")
        .stored_as<std::int32_t>(),
    Field("status", &Tick::status, "", "flags of TickStatus: what was unusual about contacts and force")
        .stored_as<std::int32_t>(),
    Field("tool_position", &Tick::tool_position, "mm", "at the other end of the virtual coupling"),
    Field("tool_orientation", &Tick::tool_orientation, "",
          "the same at the other end of the virtual coupling; zero: the tool does not turn by itself")
        .since(1, {0, 0, 0, 0}),
    Field("force", &Tick::force, "N", "on the device"),
    Field("torque", &Tick::torque, "N mm", "on the device about device_position").since(1, {0, 0, 0}),
    Field("depth", &Tick::depth, "mm", "of the device below the deepest touched rest surface"),
    Field("residual", &Tick::residual, "mm", "worst violation of the contact conditions"),
    Field("body", &Tick::body, "", "the deepest touched, -1 for none; rigid bodies first"),
    Field("contact_count", &Tick::contact_count, "", "contact points of this tick and tool"),
    Field("first_contact", &Tick::first_contact, "",
          "how many contacts were recorded before this tick's; 0 in a running loop"),
    Field("detected_tick", &Tick::detected_tick, "",
          "of whose position (published schemes) or forces (large deformation) an answer of the loop beside "
          "the "
          "ticks came in this tick; -1 for none"),
    Field("tick_ns", &Tick::tick_ns, "ns", "read, contact, force, write; handing this row over comes after"),
    Field("wake_latency_ns", &Tick::wake_latency_ns, "ns", "woken this long after the deadline"),
    Field("overruns", &Tick::overruns, "", "periods skipped so far").stored_as<std::int64_t>()};

/// A tick and its contacts. Plain bytes: crosses threads as it is.
struct TickResult : Tick {
    std::array<Contact, max_contacts> contacts;  ///< the first contact_count are valid

    std::span<const Contact> active_contacts() const noexcept {
        return {contacts.data(), static_cast<std::size_t>(contact_count)};
    }
};
static_assert(std::is_trivially_copyable_v<TickResult>);

/// Whether no fault takes of a tick's force, nor has it yet to come back after one.
inline bool has_its_force(const Tick& tick) noexcept {
    return tick.faults == no_fault && (tick.status & coming_back) == 0;
}

/// Copies a tick and the contacts that count; `to` keeps what it has beyond them. A twentieth of the bytes
/// where few points touch.
inline void copy_active(const TickResult& from, TickResult& to) noexcept {
    static_cast<Tick&>(to) = from;
    std::ranges::copy(from.active_contacts(), to.contacts.begin());
}

}  // namespace palpate
