// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/hdf5/hdf5_file.hpp"

#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/hdf5/hdf5_parser.hpp"
#include "formats/model/errors.hpp"

namespace palpate::asset {
namespace {

std::string name_of(ScalarType type) {
    switch (type) {
        case ScalarType::uint8:
            return "uint8";
        case ScalarType::int16:
            return "int16";
        case ScalarType::int32:
            return "int32";
        case ScalarType::int64:
            return "int64";
        case ScalarType::float32:
            return "float32";
        case ScalarType::float64:
            return "float64";
        default:
            return "text";
    }
}

template <typename Sizes>
std::string shape_text(const Sizes& sizes) {
    std::string text = "(";
    for (const auto size : sizes) {
        if (text.size() > 1) text += ", ";
        text += static_cast<std::int64_t>(size) == Hdf5File::any ? "any" : std::to_string(size);
    }
    return text + ")";
}

bool shape_matches(const Hdf5Shape& shape, const std::vector<std::int64_t>& wanted) {
    if (shape.size() != wanted.size()) return false;
    for (std::size_t i = 0; i < shape.size(); ++i)
        if (wanted[i] != Hdf5File::any && shape[i] != static_cast<std::uint64_t>(wanted[i])) return false;
    return true;
}

std::string unpadded(std::span<const std::byte> bytes) {
    std::string text(reinterpret_cast<const char*>(bytes.data()), bytes.size());
    text.resize(text.find_last_not_of('\0') + 1);
    return text;
}

}  // namespace

Hdf5File::Hdf5File(const std::filesystem::path& path, Held held)
    : name_(path.string()), mapping_(path, held), objects_(parse_hdf5(mapping_.bytes(), name_)) {}

void Hdf5File::refuse(const std::string& path, const std::string& found, const std::string& expected) const {
    throw InvalidInput(
        {name_ + ": " + path, found, expected, "the file is damaged or foreign; make it again"});
}

const Hdf5Object& Hdf5File::require_object(const std::string& path) const {
    const auto entry = objects_.find(path);
    if (entry == objects_.end()) refuse(path, "is missing");
    return entry->second;
}

const Hdf5Array& Hdf5File::require_dataset(const std::string& path, ScalarType type,
                                           const std::vector<std::int64_t>& shape) const {
    const Hdf5Object& object = require_object(path);
    if (!object.values) refuse(path, "is a group", "a dataset");
    const Hdf5Array& array = *object.values;
    if (array.type != type || !shape_matches(array.shape, shape))
        refuse(path, "is " + name_of(array.type) + " " + shape_text(array.shape),
               name_of(type) + " " + shape_text(shape));
    return array;
}

const Hdf5Array& Hdf5File::require_attribute(const std::string& path, const std::string& name,
                                             ScalarType type) const {
    const auto& attributes = require_object(path).attributes;
    const auto entry = attributes.find(name);
    if (entry == attributes.end()) refuse(path, "lacks attribute '" + name + "'");
    if (entry->second.type != type || !entry->second.shape.empty())
        refuse(path,
               "attribute '" + name + "' is " + name_of(entry->second.type) + " " +
                   shape_text(entry->second.shape),
               "one " + name_of(type));
    return entry->second;
}

bool Hdf5File::has_attribute(const std::string& path, const std::string& name) const {
    const auto entry = objects_.find(path);
    return entry != objects_.end() && entry->second.attributes.contains(name);
}

std::string Hdf5File::text_attribute(const std::string& path, const std::string& name) const {
    return unpadded(require_attribute(path, name, ScalarType::text).bytes);
}

std::vector<std::string> Hdf5File::texts(const std::string& path,
                                         const std::vector<std::int64_t>& shape) const {
    const Hdf5Array& array = require_dataset(path, ScalarType::text, shape);
    std::vector<std::string> texts;
    for (std::size_t at = 0; at < array.bytes.size(); at += array.element_size)
        texts.push_back(unpadded(array.bytes.subspan(at, array.element_size)));
    return texts;
}

std::map<std::string, std::string> Hdf5File::digests() const {
    std::map<std::string, std::string> digests;
    for (const auto& [path, object] : objects_) {
        if (object.values && object.values->type != ScalarType::variable_text)
            digests[path] = sha256(object.values->bytes);
        for (const auto& [name, array] : object.attributes)
            if (in_manifest(name)) digests[path + '@' + name] = sha256(array.bytes);
    }
    return digests;
}

void Hdf5File::check_digests(const std::string& manifest_path) const {
    const std::map<std::string, std::string> manifest = digests();
    for (const auto& [path, object] : objects_)
        if (const auto dataset = manifest.find(path);
            dataset != manifest.end() && dataset->second != text_attribute(path, "sha256"))
            refuse(path, "does not match its SHA-256");
    if (manifest_digest(manifest) != text_attribute(manifest_path, "manifest_sha256"))
        refuse(manifest_path, "the manifest does not match its SHA-256");
}

}  // namespace palpate::asset
