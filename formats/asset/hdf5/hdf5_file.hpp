// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <cstdint>
#include <filesystem>
#include <map>
#include <optional>
#include <span>
#include <string>
#include <vector>

#include "formats/asset/hdf5/hdf5_types.hpp"
#include "formats/asset/hdf5/mapped_file.hpp"

namespace palpate::asset {

/// The values of a dataset or an attribute, where they lie in the mapped file.
struct Hdf5Array {
    ScalarType type = ScalarType::uint8;
    std::size_t element_size = 0;  ///< bytes
    Hdf5Shape shape;               ///< empty for a scalar
    std::span<const std::byte> bytes;
};

struct Hdf5Object {
    std::optional<Hdf5Array> values;  ///< none for a group
    std::map<std::string, Hdf5Array> attributes;
};

/// Reads HDF5 files of the plain kind that Hdf5Writer makes (formats/asset/SPEC.md, "Container"), with a
/// parser of its own: the library crashes on hostile bytes (1.10.8: 64 of 3000 files mutated as in
/// tests/fuzz). It checks every header's checksum, keeps every extent within the file, follows nothing but
/// hard links, each object once, and allocates no more than the headers take up in the file. Source: The HDF
/// Group, "HDF5 File Format Specification Version 3.0".
///
/// Every function throws InvalidInput naming file, object, what was found, and the remedy.
class Hdf5File {
  public:
    explicit Hdf5File(const std::filesystem::path& path, Held held = Held::mapped);

    /// A size that a dimension may have any of, in place of a number.
    static constexpr std::int64_t any = -1;

    const std::string& name() const { return name_; }
    const MappedFile& mapping() const { return mapping_; }
    const std::map<std::string, Hdf5Object>& objects() const { return objects_; }
    bool contains(const std::string& path) const { return objects_.contains(path); }

    /// Values of a dataset of type T with the given shape; they live as long as mapping().owner().
    template <typename T>
    std::span<const T> dataset(const std::string& path, const std::vector<std::int64_t>& shape) const {
        const Hdf5Array& array = require_dataset(path, scalar_type<T>(), shape);
        return {reinterpret_cast<const T*>(array.bytes.data()), array.bytes.size() / sizeof(T)};
    }
    /// Texts of a dataset, without the zeros that pad them.
    std::vector<std::string> texts(const std::string& path, const std::vector<std::int64_t>& shape) const;

    bool has_attribute(const std::string& path, const std::string& name) const;
    template <typename T>
    T attribute(const std::string& path, const std::string& name) const {
        const Hdf5Array& array = require_attribute(path, name, scalar_type<T>());
        T value;
        std::copy_n(array.bytes.data(), sizeof(T), reinterpret_cast<std::byte*>(&value));
        return value;
    }
    std::string text_attribute(const std::string& path, const std::string& name) const;

    /// SHA-256 of every dataset by its path and of every attribute by "path@name", but for what the manifest
    /// leaves out. 0.5 s per GB.
    std::map<std::string, std::string> digests() const;

    /// Recomputes the digest of every dataset and of the manifest kept at `manifest_path`. 0.5 s per GB.
    void check_digests(const std::string& manifest_path) const;

    /// Throws InvalidInput about one of the file's objects.
    [[noreturn]] void refuse(const std::string& path, const std::string& found,
                             const std::string& expected = "") const;

  private:
    const Hdf5Object& require_object(const std::string& path) const;
    const Hdf5Array& require_dataset(const std::string& path, ScalarType type,
                                     const std::vector<std::int64_t>& shape) const;
    const Hdf5Array& require_attribute(const std::string& path, const std::string& name,
                                       ScalarType type) const;

    std::string name_;
    MappedFile mapping_;
    std::map<std::string, Hdf5Object> objects_;
};

}  // namespace palpate::asset
