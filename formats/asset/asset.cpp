// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/asset.hpp"

#include <algorithm>
#include <future>
#include <set>

#include "formats/asset/body_io.hpp"
#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/hdf5/signature.hpp"
#include "formats/asset/looks_io.hpp"
#include "formats/asset/validate.hpp"
#include "formats/asset/vtk_grid.hpp"
#include "formats/model/errors.hpp"

namespace palpate::asset {
namespace {

constexpr const char* scan_path = "/palpate/scan";

std::string rigid_path(std::size_t i) {
    return "/palpate/bodies/rigid/" + std::to_string(i);
}

std::string deformable_path(std::size_t i) {
    return "/palpate/bodies/deformable/" + std::to_string(i);
}

// Whoever looks into this JSON may do so by recursion.
void check_provenance(const std::string& json, const std::string& where) {
    constexpr int deepest = 64;
    int depth = 0;
    bool quoted = false;
    for (std::size_t i = 0; i < json.size(); ++i) {
        const char c = json[i];
        if (quoted && c == '\\')
            ++i;
        else if (c == '"')
            quoted = !quoted;
        else if (!quoted && (c == '[' || c == '{'))
            ++depth;
        else if (!quoted && (c == ']' || c == '}'))
            --depth;
        if (depth > deepest)
            throw InvalidInput({where + ": /palpate/provenance", "is nested too deeply",
                                std::to_string(deepest) + " levels at most", "pack the case again"});
    }
}

void check_case(const Case& patient_case, const std::string& where) {
    check_provenance(patient_case.provenance, where);
    check_name(patient_case.name, where + ": /palpate");
    check_haptics(patient_case.haptics, where + ": /palpate/haptics");
    if (patient_case.rigid_bodies.empty() && patient_case.deformable_bodies.empty())
        throw InvalidInput({where, "has no bodies", "at least one", "pack a rigid or a deformable body"});
    std::set<std::string> names;
    const auto claim = [&](const std::string& name) {
        if (!names.insert(name).second)
            throw InvalidInput({where, "has two bodies '" + name + "'", "", "give each body its own name"});
    };
    for (const RigidBody& body : patient_case.rigid_bodies) claim(body.name);
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        claim(body.name);
        if (body.feel && body.feel->tool_radius != patient_case.haptics.tool_radius)
            throw InvalidInput(
                {where + ": " + body.name,
                 "says what is felt with a tool of " + std::to_string(body.feel->tool_radius) + " mm radius",
                 std::to_string(patient_case.haptics.tool_radius) + " mm as in the haptic settings",
                 "run 'palpate pack' again"});
    }
}

// One that is not in the row would be left out in silence.
void require_members(const Hdf5File& file, const std::string& group, std::size_t count) {
    const std::string prefix = group + '/';
    std::size_t found = 0;
    for (auto entry = file.objects().lower_bound(prefix);
         entry != file.objects().end() && entry->first.starts_with(prefix); ++entry)
        found += entry->first.find('/', prefix.size()) == std::string::npos;
    if (found != count)
        throw InvalidInput({file.name() + ": " + group,
                            "has " + std::to_string(found) + " bodies, not all of them named in a row",
                            "0, 1, ... without gaps", "pack the case again"});
}

Case read_case(const Hdf5File& file) {
    Case patient_case;
    patient_case.name = file.text_attribute("/palpate", "name");
    for (std::size_t i = 0; file.contains(rigid_path(i)); ++i)
        patient_case.rigid_bodies.push_back(read_rigid_body(file, rigid_path(i)));
    require_members(file, "/palpate/bodies/rigid", patient_case.rigid_bodies.size());
    for (std::size_t i = 0; file.contains(deformable_path(i)); ++i) {
        DeformableBody body = read_condensed_body(file, deformable_path(i));
        body.obb_tree = read_obb_tree(file, deformable_path(i) + "/obb_tree", body.boundary.surface);
        body.feel = read_feel(file, deformable_path(i) + "/feel", body);
        patient_case.deformable_bodies.push_back(std::move(body));
    }
    require_members(file, "/palpate/bodies/deformable", patient_case.deformable_bodies.size());
    read_fields(file, "/palpate/haptics", haptic_fields, patient_case.haptics);
    patient_case.scan = read_scan(file, scan_path);
    patient_case.provenance = file.texts("/palpate/provenance", {}).front();
    check_case(patient_case, file.name());
    return patient_case;
}

std::optional<std::string> signer_of(const Hdf5File& file) {
    if (!file.has_attribute("/palpate", "signature") && !file.has_attribute("/palpate", "public_key"))
        return std::nullopt;
    const Signature signature{file.text_attribute("/palpate", "signature"),
                              file.text_attribute("/palpate", "public_key")};
    if (!is_signed(file.text_attribute("/palpate", "manifest_sha256"), signature))
        throw InvalidInput(
            {file.name(), "has a signature that is false", "", "do not use it; ask who made it"});
    return signature.public_key;
}

// A signature must hold whoever is trusted; with keys, it must be there and of one of them.
void require_signature(const Hdf5File& file, std::span<const std::string> trusted_keys) {
    const auto signer = signer_of(file);
    if (trusted_keys.empty()) return;
    if (!signer)
        throw InvalidInput({file.name(), "is not signed", "the signature of a trusted key",
                            "ask who made it to sign it: 'palpate pack --sign'"});
    if (std::ranges::find(trusted_keys, *signer) == trusted_keys.end())
        throw InvalidInput({file.name(), "is signed by " + *signer, "a trusted key",
                            "trust that key only if you know whose it is"});
}

Case read_checked(const Hdf5File& file, std::span<const std::string> trusted_keys) {
    check_header(file, "case");
    require_signature(file, trusted_keys);
    // A wrong digest explains whatever else is wrong, so it is reported first.
    auto checked = std::async(std::launch::async, [&] { file.check_digests("/palpate"); });
    try {
        Case patient_case = read_case(file);
        checked.get();
        return patient_case;
    } catch (const InvalidInput&) {
        if (checked.valid()) checked.get();
        throw;
    }
}

}  // namespace

void write_asset(const std::filesystem::path& path, const Case& patient_case,
                 const std::filesystem::path& private_key) {
    const std::string where = "case '" + patient_case.name + "'";
    check_case(patient_case, where);
    for (const RigidBody& body : patient_case.rigid_bodies) {
        check_name(body.name, where);
        check_surface(body.surface, where + ": " + body.name);
        check_sides(body.surface, where + ": " + body.name);
        check_obb_tree(body.obb_tree, body.surface.triangles.size(), where + ": " + body.name + "/obb_tree");
        check_enclosure(body.obb_tree, body.surface, where + ": " + body.name + "/obb_tree");
    }
    for (const DeformableBody& body : patient_case.deformable_bodies) {
        check_body(body, where + ": " + body.name);
        check_obb_tree(body.obb_tree, body.boundary.surface.triangles.size(),
                       where + ": " + body.name + "/obb_tree");
        check_enclosure(body.obb_tree, body.boundary.surface, where + ": " + body.name + "/obb_tree");
        if (body.feel) check_feel(*body.feel, body, where + ": " + body.name + "/feel");
    }
    if (patient_case.scan) check_scan(*patient_case.scan, where + ": scan");

    Hdf5Writer writer(path);
    write_header(writer, "case");
    writer.attribute("/palpate", "name", patient_case.name);
    for (std::size_t i = 0; i < patient_case.rigid_bodies.size(); ++i)
        write_rigid_body(writer, rigid_path(i), patient_case.rigid_bodies[i]);
    for (std::size_t i = 0; i < patient_case.deformable_bodies.size(); ++i) {
        const DeformableBody& body = patient_case.deformable_bodies[i];
        write_condensed_body(writer, deformable_path(i), body, mechanics_digest(body));
        write_obb_tree(writer, deformable_path(i) + "/obb_tree", body.obb_tree, body.boundary.surface);
        if (body.feel) write_feel(writer, deformable_path(i) + "/feel", *body.feel);
    }
    writer.group("/palpate/haptics");
    write_fields(writer, "/palpate/haptics", haptic_fields, patient_case.haptics);
    if (patient_case.scan) write_scan(writer, scan_path, *patient_case.scan);
    writer.texts("/palpate/provenance", {patient_case.provenance}, {});
    write_vtk_grid(writer, patient_case);
    writer.finish("/palpate", private_key);
}

Case read_asset(const std::filesystem::path& path, Digests digests) {
    const Hdf5File file(path);
    if (digests == Digests::check) return read_checked(file, {});
    check_header(file, "case");
    return read_case(file);
}

Case read_asset(const std::filesystem::path& path, std::span<const std::string> trusted_keys) {
    return read_checked(Hdf5File(path), trusted_keys);
}

Case load_asset(const std::filesystem::path& path, std::span<const std::string> trusted_keys) {
    return read_checked(Hdf5File(path, Held::copied), trusted_keys);
}

std::optional<std::string> signer_of(const std::filesystem::path& path) {
    const Hdf5File file(path);
    check_header(file, "case");
    return signer_of(file);
}

std::string asset_digest(const std::filesystem::path& path) {
    const Hdf5File file(path);
    check_header(file, "case");
    return file.text_attribute("/palpate", "manifest_sha256");
}

std::vector<std::string> unlike_written_again(const std::filesystem::path& path, const Case& patient_case,
                                              const std::filesystem::path& scratch) {
    write_asset(scratch, patient_case);
    const auto ours = Hdf5File(path).digests(), again = Hdf5File(scratch).digests();
    std::vector<std::string> unlike;
    const auto dataset_of = [](const std::string& object) { return object.substr(0, object.find('@')); };
    for (const auto& [object, digest] : ours) {
        const auto found = again.find(object);
        // Of what is written, an attribute that is not.
        const bool known = found != again.end() || again.contains(dataset_of(object));
        if (known && (found == again.end() || found->second != digest)) unlike.push_back(object);
    }
    for (const auto& [object, digest] : again)
        if (!ours.contains(object) && ours.contains(dataset_of(object))) unlike.push_back(object);
    return unlike;
}

std::vector<std::string> differences(const std::filesystem::path& one, const std::filesystem::path& other) {
    const auto ours = Hdf5File(one).digests(), theirs = Hdf5File(other).digests();
    std::vector<std::string> different;
    for (const auto& [path, digest] : ours)
        if (const auto found = theirs.find(path); found == theirs.end() || found->second != digest)
            different.push_back(path);
    for (const auto& [path, digest] : theirs)
        if (!ours.contains(path)) different.push_back(path);
    return different;
}

}  // namespace palpate::asset
