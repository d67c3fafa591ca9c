// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <limits>
#include <memory>
#include <span>
#include <string>
#include <string_view>

#include "formats/model/body.hpp"
#include "runtime/haptics/contact/contact_bodies.hpp"
#include "runtime/haptics/methods/contact_method.hpp"

namespace palpate::haptics {

/// What a contact method knows and needs.
struct ContactCapabilities {
    bool has_radius = false;        ///< a tool is a sphere of its radius; otherwise a point
    bool spreads_loads = false;     ///< on tissue, so that it does not feel the mesh: LoadSpread
    bool deforms_far = false;       ///< tissue may be neo-Hookean: Case::hyperelastic
    bool sums_rigid_walls = false;  ///< where only rigid walls hold the tip, one contact is their resultant
    bool creeps = false;            ///< as tissue does that relaxes
    bool feels_tissue = true;       ///< and not rigid bodies alone
    bool turns = false;             ///< a tool may turn by itself, with a torque: Case::tool
    bool always_turns = false;      ///< and does where a case has none
    bool samples_surface = false;   ///< as points against voxels
    bool gives_way = false;         ///< touches are springs: ToolSettings::contact_stiffness
    bool keeps_energy = false;  ///< gives hands no more than they gave it: PassivityObserver holds it to that
    std::size_t most_tools = std::numeric_limits<std::size_t>::max();
};

/// One way of contact.
struct ContactMethodEntry {
    std::string_view name;      ///< as --scheme, recordings and reports have it
    std::string_view sentence;  ///< what it does, for a reader of the help
    ContactCapabilities can;
    /// Allocates it for `tool_count` tools on the bodies of a case, which must outlive it. Throws
    /// InvalidInput if compliance and surface do not belong together.
    std::unique_ptr<ContactMethod> (*make)(const Case& patient_case, const ContactBodies& bodies,
                                           std::size_t tool_count);
};

/// What is meant where nobody names one.
inline constexpr std::string_view usual_contact_method = "continuous";

/// All there are. A new one is files of its own and a line in this table, in contact_methods.cpp.
std::span<const ContactMethodEntry> contact_methods();
/// By name; throws UsageError of `culprit` listing the names.
const ContactMethodEntry& find_contact_method(std::string_view name,
                                              const std::string& culprit = "contact method");

/// "single, twice, ... or continuous": the names of the methods that take at least `tool_count` tools.
std::string contact_method_names(std::size_t tool_count = 1);
/// The names of those that can do one thing, likewise.
std::string contact_method_names(bool ContactCapabilities::*can);
/// "'single' is published: ...; 'twice' ...": the whole table in words.
std::string contact_method_sentences();

}  // namespace palpate::haptics
