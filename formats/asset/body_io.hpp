// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>
#include <type_traits>

#include "formats/asset/hdf5/hdf5_file.hpp"
#include "formats/asset/hdf5/hdf5_writer.hpp"
#include "formats/model/body.hpp"
#include "formats/records/field.hpp"

namespace palpate::asset {

/// Groups of formats/asset/SPEC.md, written and read. Readers return values that validate.hpp has passed.

/// What a file is, as attributes of /palpate; `kind` is "case", "body" or "obb_tree".
void write_header(Hdf5Writer& writer, const std::string& kind);
/// Throws InvalidInput if the file is of a newer schema, of another kind, or in another frame.
void check_header(const Hdf5File& file, const std::string& kind);
/// The kind that a file says it is; throws InvalidInput if it is none of palpate's.
std::string header_kind(const Hdf5File& file);

void write_obb_tree(Hdf5Writer& writer, const std::string& path, const ObbTree& tree,
                    const TriangleMesh& surface);
/// Throws InvalidInput if the tree was built over another surface.
ObbTree read_obb_tree(const Hdf5File& file, const std::string& path, const TriangleMesh& surface);
/// The same over whichever surface has its digest.
ObbTree read_obb_tree(const Hdf5File& file, const std::string& path);
std::string surface_digest_of_obb_tree(const Hdf5File& file, const std::string& path);

void write_feel(Hdf5Writer& writer, const std::string& path, const Feel& feel);
/// What can be felt of a body that is otherwise read; none in a file without it.
std::optional<Feel> read_feel(const Hdf5File& file, const std::string& path, const DeformableBody& body);

void write_rigid_body(Hdf5Writer& writer, const std::string& path, const RigidBody& body);
RigidBody read_rigid_body(const Hdf5File& file, const std::string& path);

/// Whether a body is to be felt as neo-Hookean tissue; not so in a file that does not say.
bool read_large_deformation(const Hdf5File& file, const std::string& path);

/// Everything but the OBB tree. `mechanics` is the digest of what the compliance was condensed from.
void write_condensed_body(Hdf5Writer& writer, const std::string& path, const DeformableBody& body,
                          const std::string& mechanics);
DeformableBody read_condensed_body(const Hdf5File& file, const std::string& path);

/// Writes every field of a record as an attribute of `path`.
template <typename Table, typename Record>
void write_fields(Hdf5Writer& writer, const std::string& path, const Table& table, const Record& record) {
    for_each_field(table,
                   [&](const auto& field) { writer.attribute(path, field.name, record.*field.member); });
}

/// Reads what write_fields() wrote; a field that the file lacks has the value that its absence means.
template <typename Table, typename Record>
void read_fields(const Hdf5File& file, const std::string& path, const Table& table, Record& record) {
    for_each_field(table, [&](const auto& field) {
        using Value = typename std::remove_cvref_t<decltype(field)>::Value;
        record.*field.member = field.absent && !file.has_attribute(path, field.name)
                                   ? *field.absent
                                   : file.attribute<Value>(path, field.name);
    });
}

}  // namespace palpate::asset
