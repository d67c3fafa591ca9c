// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "formats/asset/hdf5/hdf5_types.hpp"

namespace palpate::asset {

/// Writes an HDF5 file of the plain kind that Hdf5File reads: hard links, contiguous datasets on 64-byte
/// boundaries, checksummed headers, no times; equal calls give equal bytes. Every dataset gets its digest as
/// attribute `sha256`. Groups are made as datasets and attributes need them. Every function throws
/// SystemFailure if the file cannot be written.
class Hdf5Writer {
  public:
    explicit Hdf5Writer(const std::filesystem::path& path);
    Hdf5Writer(const Hdf5Writer&) = delete;
    Hdf5Writer& operator=(const Hdf5Writer&) = delete;
    ~Hdf5Writer();

    /// Writes shape[0] x shape[1] x ... values; `unit` becomes an attribute unless it is empty.
    template <typename T>
    void dataset(const std::string& path, std::span<const T> values, const Hdf5Shape& shape,
                 std::string_view unit = "") {
        write_dataset(path, scalar_type<T>(), sizeof(T), std::as_bytes(values), shape, unit);
    }
    /// Makes room for values that somebody else writes into the file later, without a digest; finish() is
    /// not for files with such datasets, close() is.
    template <typename T>
    void reserve(const std::string& path, const Hdf5Shape& shape, std::string_view unit = "") {
        reserve_dataset(path, scalar_type<T>(), sizeof(T), shape, unit);
    }
    /// Writes texts, each padded with zeros to the longest; `shape` is {} for one text, {n} for n of them.
    void texts(const std::string& path, const std::vector<std::string>& values, const Hdf5Shape& shape);
    /// Writes texts of variable length, without a digest; see ScalarType::variable_text.
    void variable_texts(const std::string& path, const std::vector<std::string>& values);

    /// Adds an attribute to a group or dataset: a scalar, or a list with `shape` {n}.
    template <typename T>
    requires std::is_arithmetic_v<T>
    void attribute(const std::string& path, const std::string& name, T value) {
        write_attribute(path, name, scalar_type<T>(), sizeof(T), std::as_bytes(std::span(&value, 1)), {});
    }
    void attribute(const std::string& path, const std::string& name, std::string_view text);
    void attribute(const std::string& path, const std::string& name, const std::vector<std::int32_t>& values);

    void group(const std::string& path);

    /// Adds the manifest's digest to `path` as attribute `manifest_sha256`, with a key its signature too, and
    /// closes the file. Throws as sign_manifest().
    void finish(const std::string& path, const std::filesystem::path& private_key = {});
    /// Closes the file without a manifest.
    void close();

  private:
    void write_dataset(const std::string& path, ScalarType type, std::size_t element_size,
                       std::span<const std::byte> bytes, const Hdf5Shape& shape, std::string_view unit);
    void reserve_dataset(const std::string& path, ScalarType type, std::size_t element_size,
                         const Hdf5Shape& shape, std::string_view unit);
    void write_attribute(const std::string& path, const std::string& name, ScalarType type,
                         std::size_t element_size, std::span<const std::byte> bytes, const Hdf5Shape& shape);
    void create_dataset(const std::string& path, std::int64_t type, const Hdf5Shape& shape,
                        const void* values);
    [[noreturn]] void fail() const;
    std::int64_t require(std::int64_t result) const;

    std::string file_name_;
    std::int64_t file_ = -1;                       // hid_t
    std::map<std::string, std::string> manifest_;  // path or path@attribute -> sha256
};

}  // namespace palpate::asset
