// SPDX-License-Identifier: GPL-3.0-or-later
#include <hdf5.h>
#include <memory>

#include "tools/archive/privacy/searches.hpp"

namespace palpate::archive {
namespace {

struct Hdf5Search {
    const std::filesystem::path& file;
    const Machine& machine;
    Findings& findings;
};

// All strings of an attribute or dataset, by the reader of either; nothing if it holds none.
template <typename Read>
std::vector<std::string> strings_of(hid_t type, hid_t space, const Read& read) {
    std::vector<std::string> strings;
    const hssize_t count = H5Sget_simple_extent_npoints(space);
    if (H5Tget_class(type) != H5T_STRING || count <= 0 || count > 1000000) return strings;
    const std::size_t number = static_cast<std::size_t>(count);
    if (H5Tis_variable_str(type) > 0) {
        std::vector<char*> pointers(number, nullptr);
        const hid_t memory = H5Tcopy(type);
        if (read(memory, pointers.data()) >= 0) {
            for (const char* text : pointers)
                if (text != nullptr) strings.emplace_back(text);
            H5Dvlen_reclaim(memory, space, H5P_DEFAULT, pointers.data());
        }
        H5Tclose(memory);
        return strings;
    }
    const std::size_t size = H5Tget_size(type);
    if (size == 0 || number > 100000000 / size) return strings;
    std::string bytes(size * number, '\0');
    if (read(type, bytes.data()) < 0) return strings;
    for (std::size_t i = 0; i < number; ++i) strings.emplace_back(bytes.substr(i * size, size).c_str());
    return strings;
}

void search_strings(const std::vector<std::string>& strings, const std::string& where,
                    const Hdf5Search& search) {
    for (const std::string& text : strings)
        search_text(text, search.file, where, false, search.machine, search.findings);
}

herr_t visit_attribute(hid_t object, const char* name, const H5A_info_t* /*info*/, void* data) {
    const auto& [path, search] = *static_cast<std::pair<std::string, const Hdf5Search*>*>(data);
    const std::string where = path + ", attribute " + name;
    search_text(name, search->file, where, false, search->machine, search->findings);
    const hid_t attribute = H5Aopen(object, name, H5P_DEFAULT);
    if (attribute < 0) return 0;
    const hid_t type = H5Aget_type(attribute), space = H5Aget_space(attribute);
    search_strings(
        strings_of(type, space, [&](hid_t memory, void* to) { return H5Aread(attribute, memory, to); }),
        where, *search);
    H5Sclose(space);
    H5Tclose(type);
    H5Aclose(attribute);
    return 0;
}

herr_t visit_object(hid_t root, const char* name, const H5O_info_t* info, void* data) {
    const auto& search = *static_cast<const Hdf5Search*>(data);
    std::pair<std::string, const Hdf5Search*> place{std::string("/") + (std::string(name) == "." ? "" : name),
                                                    &search};
    search_text(name, search.file, "a name", false, search.machine, search.findings);
    const hid_t object = H5Oopen(root, name, H5P_DEFAULT);
    if (object < 0) return 0;
    hsize_t next = 0;
    H5Aiterate2(object, H5_INDEX_NAME, H5_ITER_INC, &next, visit_attribute, &place);
    if (info->type == H5O_TYPE_DATASET) {
        const hid_t type = H5Dget_type(object), space = H5Dget_space(object);
        search_strings(strings_of(type, space,
                                  [&](hid_t memory, void* to) {
                                      return H5Dread(object, memory, H5S_ALL, H5S_ALL, H5P_DEFAULT, to);
                                  }),
                       place.first, search);
        // Text kept as bytes, such as JSON.
        const hssize_t count = H5Sget_simple_extent_npoints(space);
        if (H5Tget_class(type) == H5T_INTEGER && H5Tget_size(type) == 1 && count > 0 && count < 100000000) {
            std::string bytes(static_cast<std::size_t>(count), '\0');
            if (H5Dread(object, type, H5S_ALL, H5S_ALL, H5P_DEFAULT, bytes.data()) >= 0)
                search_bytes(bytes, search.file, search.machine, search.findings);
        }
        H5Sclose(space);
        H5Tclose(type);
    }
    H5Oclose(object);
    return 0;
}

}  // namespace

bool search_hdf5(const std::filesystem::path& file, const Machine& machine, Findings& findings) {
    H5Eset_auto2(H5E_DEFAULT, nullptr, nullptr);
    const hid_t opened = H5Fopen(file.c_str(), H5F_ACC_RDONLY, H5P_DEFAULT);
    if (opened < 0) return false;
    Hdf5Search search{file, machine, findings};
    const herr_t visited =
        H5Ovisit2(opened, H5_INDEX_NAME, H5_ITER_INC, visit_object, &search, H5O_INFO_BASIC);
    H5Fclose(opened);
    return visited >= 0;
}

}  // namespace palpate::archive
