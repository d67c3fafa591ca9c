// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/hdf5/hdf5_writer.hpp"

#include <algorithm>
#include <cstring>
#include <hdf5.h>

#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/hdf5/signature.hpp"
#include "formats/model/errors.hpp"

namespace palpate::asset {
namespace {

static_assert(sizeof(hid_t) == sizeof(std::int64_t));

// An HDF5 identifier, closed when it goes out of scope.
class Handle {
  public:
    Handle(std::int64_t id, herr_t (*close)(hid_t)) : id_(id), close_(close) {}
    Handle(const Handle&) = delete;
    Handle& operator=(const Handle&) = delete;
    ~Handle() { close_(id_); }
    operator hid_t() const { return id_; }  // NOLINT: an identifier is what HDF5 functions take

  private:
    hid_t id_;
    herr_t (*close_)(hid_t);
};

// HDF5 prints its error stack by default; what a user should know is said in our exceptions.
class QuietErrors {
  public:
    QuietErrors() {
        H5Eget_auto2(H5E_DEFAULT, &function_, &data_);
        H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    }
    QuietErrors(const QuietErrors&) = delete;
    QuietErrors& operator=(const QuietErrors&) = delete;
    ~QuietErrors() { H5Eset_auto2(H5E_DEFAULT, function_, data_); }

  private:
    H5E_auto2_t function_ = nullptr;
    void* data_ = nullptr;
};

hid_t number_type(ScalarType type) {
    switch (type) {
        case ScalarType::uint8:
            return H5T_STD_U8LE;
        case ScalarType::int16:
            return H5T_STD_I16LE;
        case ScalarType::int32:
            return H5T_STD_I32LE;
        case ScalarType::int64:
            return H5T_STD_I64LE;
        case ScalarType::float32:
            return H5T_IEEE_F32LE;
        default:
            return H5T_IEEE_F64LE;
    }
}

// ASCII wherever it suffices: newer VTK readers insist on it for the type of a grid.
hid_t make_type(ScalarType type, std::size_t element_size, std::span<const std::byte> bytes) {
    if (type != ScalarType::text) return H5Tcopy(number_type(type));
    const hid_t text = H5Tcopy(H5T_C_S1);
    H5Tset_size(text, element_size);
    H5Tset_strpad(text, H5T_STR_NULLPAD);
    const bool ascii = std::ranges::all_of(bytes, [](std::byte b) { return b < std::byte{0x80}; });
    H5Tset_cset(text, ascii ? H5T_CSET_ASCII : H5T_CSET_UTF8);
    return text;
}

hid_t make_space(const Hdf5Shape& shape) {
    if (shape.empty()) return H5Screate(H5S_SCALAR);
    const std::vector<hsize_t> dims(shape.begin(), shape.end());
    return H5Screate_simple(static_cast<int>(dims.size()), dims.data(), nullptr);
}

// Links and attributes stay in the object header, where the reader looks for them; times would make the
// bytes differ from run to run.
void keep_plain(hid_t creation, bool with_links) {
    constexpr unsigned most = 4096;
    H5Pset_obj_track_times(creation, false);
    H5Pset_attr_phase_change(creation, most, 0);
    if (with_links) H5Pset_link_phase_change(creation, most, 0);
}

}  // namespace

Hdf5Writer::Hdf5Writer(const std::filesystem::path& path) : file_name_(path.string()) {
    // Where the disk was full, HDF5 1.10 would crash while closing the file once more on exit.
    H5dont_atexit();
    const QuietErrors quiet;
    const Handle creation(H5Pcreate(H5P_FILE_CREATE), H5Pclose);
    keep_plain(creation, true);
    const Handle access(H5Pcreate(H5P_FILE_ACCESS), H5Pclose);
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
    H5Pset_alignment(access, 1, 64);
    H5Pset_file_locking(access, false,
                        true);  // the file is the caller's own; network file systems lack locks
    // HDF5's usual driver asks realpath() what a link leads to, which fails for the /proc/self/fd of a file
    // without a name.
    H5Pset_fapl_stdio(access);
    file_ = require(H5Fcreate(file_name_.c_str(), H5F_ACC_TRUNC, creation, access));
}

Hdf5Writer::~Hdf5Writer() {
    const QuietErrors quiet;
    if (file_ >= 0) H5Fclose(file_);
}

void Hdf5Writer::fail() const {
    throw SystemFailure(
        {file_name_, "could not be written", "", "check free space and permissions of its folder"});
}

std::int64_t Hdf5Writer::require(std::int64_t result) const {
    if (result < 0) fail();
    return result;
}

void Hdf5Writer::group(const std::string& path) {
    if (path.size() <= 1) return;
    const QuietErrors quiet;
    for (std::size_t slash = path.find('/', 1);; slash = path.find('/', slash + 1)) {
        const std::string part = path.substr(0, slash);
        if (H5Lexists(file_, part.c_str(), H5P_DEFAULT) <= 0) {
            const Handle creation(H5Pcreate(H5P_GROUP_CREATE), H5Pclose);
            keep_plain(creation, true);
            const Handle made(H5Gcreate2(file_, part.c_str(), H5P_DEFAULT, creation, H5P_DEFAULT), H5Gclose);
            require(made);
        }
        if (slash == std::string::npos) return;
    }
}

void Hdf5Writer::create_dataset(const std::string& path, std::int64_t type, const Hdf5Shape& shape,
                                const void* values) {
    group(path.substr(0, path.rfind('/')));
    const QuietErrors quiet;
    const Handle creation(H5Pcreate(H5P_DATASET_CREATE), H5Pclose);
    keep_plain(creation, false);
    H5Pset_layout(creation, H5D_CONTIGUOUS);
    H5Pset_alloc_time(creation, H5D_ALLOC_TIME_EARLY);
    if (H5Tis_variable_str(type) == 0) H5Pset_fill_time(creation, H5D_FILL_TIME_NEVER);
    const Handle space(make_space(shape), H5Sclose);
    const Handle made(H5Dcreate2(file_, path.c_str(), type, space, H5P_DEFAULT, creation, H5P_DEFAULT),
                      H5Dclose);
    require(made);
    if (values) require(H5Dwrite(made, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, values));
}

void Hdf5Writer::write_dataset(const std::string& path, ScalarType type, std::size_t element_size,
                               std::span<const std::byte> bytes, const Hdf5Shape& shape,
                               std::string_view unit) {
    const Handle element(make_type(type, element_size, bytes), H5Tclose);
    create_dataset(path, element, shape, bytes.empty() ? nullptr : bytes.data());
    manifest_[path] = sha256(bytes);
    attribute(path, "sha256", manifest_[path]);
    if (!unit.empty()) attribute(path, "unit", unit);
}

void Hdf5Writer::reserve_dataset(const std::string& path, ScalarType type, std::size_t element_size,
                                 const Hdf5Shape& shape, std::string_view unit) {
    const Handle element(make_type(type, element_size, {}), H5Tclose);
    create_dataset(path, element, shape, nullptr);
    if (!unit.empty()) attribute(path, "unit", unit);
}

void Hdf5Writer::texts(const std::string& path, const std::vector<std::string>& values,
                       const Hdf5Shape& shape) {
    std::size_t width = 1;  // HDF5 has no text of length 0
    for (const std::string& value : values) width = std::max(width, value.size());
    std::vector<std::byte> bytes(width * values.size());
    for (std::size_t i = 0; i < values.size(); ++i)
        std::memcpy(bytes.data() + i * width, values[i].data(), values[i].size());
    write_dataset(path, ScalarType::text, width, bytes, shape, "");
}

void Hdf5Writer::variable_texts(const std::string& path, const std::vector<std::string>& values) {
    const Handle element(H5Tcopy(H5T_C_S1), H5Tclose);
    H5Tset_size(element, H5T_VARIABLE);
    std::vector<const char*> pointers;
    for (const std::string& value : values) pointers.push_back(value.c_str());
    create_dataset(path, element, {values.size()}, pointers.empty() ? nullptr : pointers.data());
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name, std::string_view text) {
    write_attribute(path, name, ScalarType::text, text.size(), std::as_bytes(std::span(text)), {});
}

void Hdf5Writer::attribute(const std::string& path, const std::string& name,
                           const std::vector<std::int32_t>& values) {
    write_attribute(path, name, ScalarType::int32, sizeof(std::int32_t), std::as_bytes(std::span(values)),
                    {values.size()});
}

void Hdf5Writer::write_attribute(const std::string& path, const std::string& name, ScalarType type,
                                 std::size_t element_size, std::span<const std::byte> bytes,
                                 const Hdf5Shape& shape) {
    const QuietErrors quiet;
    const Handle object(H5Oopen(file_, path.c_str(), H5P_DEFAULT), H5Oclose);
    require(object);
    const Handle element(make_type(type, element_size, bytes), H5Tclose);
    const Handle space(make_space(shape), H5Sclose);
    const Handle made(H5Acreate2(object, name.c_str(), element, space, H5P_DEFAULT, H5P_DEFAULT), H5Aclose);
    require(made);
    require(H5Awrite(made, element, bytes.data()));
    if (in_manifest(name)) manifest_[path + '@' + name] = sha256(bytes);
}

void Hdf5Writer::finish(const std::string& path, const std::filesystem::path& private_key) {
    const std::string digest = manifest_digest(manifest_);
    attribute(path, "manifest_sha256", digest);
    if (!private_key.empty()) {
        const Signature made = sign_manifest(digest, private_key);
        attribute(path, "public_key", made.public_key);
        attribute(path, "signature", made.signature);
    }
    close();
}

void Hdf5Writer::close() {
    const QuietErrors quiet;
    require(H5Fflush(file_, H5F_SCOPE_GLOBAL));
    require(H5Fclose(file_));
    file_ = -1;
}

}  // namespace palpate::asset
