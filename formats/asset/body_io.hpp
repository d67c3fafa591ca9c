// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>

#include "formats/asset/hdf5/hdf5_file.hpp"
#include "formats/asset/hdf5/hdf5_writer.hpp"
#include "formats/model/body.hpp"

namespace palpate {

/// Groups of formats/asset/SPEC.md, written and read. Readers return values that validate.hpp has passed.

/// What a file is, as attributes of /palpate; `kind` is "case", "body" or "obb_tree".
void write_header(Hdf5Writer& writer, const std::string& kind);
/// Throws InvalidInput if the file is of a newer schema, of another kind, or in another frame.
void check_header(const Hdf5File& file, const std::string& kind);

void write_obb_tree(Hdf5Writer& writer, const std::string& path, const ObbTree& tree,
                    const TriangleMesh& surface);
ObbTree read_obb_tree(const Hdf5File& file, const std::string& path, const TriangleMesh& surface);

void write_rigid_body(Hdf5Writer& writer, const std::string& path, const RigidBody& body);
RigidBody read_rigid_body(const Hdf5File& file, const std::string& path);

/// Everything but the OBB tree. `mechanics` is the digest of what the compliance was condensed from.
void write_condensed_body(Hdf5Writer& writer, const std::string& path, const DeformableBody& body,
                          const std::string& mechanics);
DeformableBody read_condensed_body(const Hdf5File& file, const std::string& path);

/// The certificate's figures by their names in the file; the same list serves writing and reading.
template <typename Certificate, typename Visit>
void visit_certificate(Certificate& certificate, Visit&& visit) {
    visit("residual", certificate.residual);
    visit("residual_double", certificate.residual_double);
    visit("asymmetry", certificate.asymmetry);
    visit("smallest_eigenvalue", certificate.smallest_eigenvalue);
    visit("largest_eigenvalue", certificate.largest_eigenvalue);
    visit("condition_number", certificate.condition_number);
    visit("reciprocity", certificate.reciprocity);
    visit("load_error", certificate.load_error);
    visit("contact_error", certificate.contact_error);
    visit("sampled_loads", certificate.sampled_loads);
    visit("smallest_patch_eigenvalue", certificate.smallest_patch_eigenvalue);
    visit("discretisation_error", certificate.discretisation_error);
    visit("sampled_columns", certificate.sampled_columns);
    visit("free_dofs", certificate.free_dofs);
}

template <typename Haptics, typename Visit>
void visit_haptics(Haptics& haptics, Visit&& visit) {
    visit("tool_radius", haptics.tool_radius);
    visit("coupling_stiffness", haptics.coupling_stiffness);
    visit("max_force", haptics.max_force);
    visit("max_force_rate", haptics.max_force_rate);
}

/// Settings that older files lack; they mean what HapticSettings{} says then.
template <typename Haptics, typename Visit>
void visit_later_haptics(Haptics& haptics, Visit&& visit) {
    visit("friction_at_rest", haptics.friction_at_rest);
    visit("friction_sliding", haptics.friction_sliding);
    visit("shaft_length", haptics.shaft_length);
}

}  // namespace palpate
