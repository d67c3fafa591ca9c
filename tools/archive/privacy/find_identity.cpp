// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/archive/privacy/find_identity.hpp"

#include <algorithm>
#include <fstream>
#include <iterator>
#include <memory>
#include <zlib.h>

#include "formats/model/errors.hpp"
#include "tools/archive/privacy/searches.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace palpate::archive {
namespace {

InvalidInput unreadable(const std::filesystem::path& file, const std::string& found) {
    return InvalidInput(
        {file.string(), found, "a file that can be searched whole", "check or leave out the file"});
}

// A file's bytes, unpacked if it is gzip.
std::string bytes_of(const std::filesystem::path& file) {
    const std::unique_ptr<gzFile_s, int (*)(gzFile)> stream(gzopen(file.c_str(), "rb"), gzclose);
    if (!stream) throw unreadable(file, "cannot be read");
    std::string bytes;
    std::vector<char> block(1 << 20);
    for (int got = 1; got > 0;) {
        got = gzread(stream.get(), block.data(), static_cast<unsigned>(block.size()));
        if (got < 0) throw unreadable(file, "is damaged");
        bytes.append(block.data(), static_cast<std::size_t>(got));
    }
    return bytes;
}

bool starts_as_text(std::string_view bytes) {
    return bytes.substr(0, 4096).find('\0') == std::string_view::npos;
}

void search_file(const std::filesystem::path& file, const Machine& machine, Findings& findings) {
    search_text(file.filename().string(), file, "its name", false, machine, findings);
    if (imaging::is_dicom(file)) {
        if (!search_dicom(file, machine, findings)) throw unreadable(file, "is damaged DICOM");
        return;
    }
    const std::string bytes = bytes_of(file);
    const std::string_view view = bytes;
    if (view.starts_with("\x89HDF\r\n")) {
        if (!search_hdf5(file, machine, findings)) throw unreadable(file, "is damaged HDF5");
        if (file.extension() == ".vtkhdf") search_asset_face(file, findings);
    } else if (imaging::is_nifti(file)) {
        search_nifti(view, file, machine, findings);
        search_volume_face(file, findings);
    } else if (view.starts_with("NRRD")) {
        search_nrrd(view, file, machine, findings);
        search_volume_face(file, findings);
    } else if (file.extension() == ".mha" || file.extension() == ".mhd") {
        search_metaimage(view, file, machine, findings);
        search_volume_face(file, findings);
    } else if (const auto appended = view.find("<AppendedData");
               view.starts_with("<?xml") && appended != std::string_view::npos) {
        search_text(view.substr(0, appended), file, "", true, machine, findings);
        search_bytes(view.substr(appended), file, machine, findings);
    } else if (starts_as_text(view)) {
        search_text(view, file, "", true, machine, findings);
    } else {
        search_bytes(view, file, machine, findings);
    }
}

}  // namespace

PrivacyReport find_identity(const std::vector<std::filesystem::path>& paths, const Machine& machine) {
    std::vector<std::filesystem::path> files;
    for (const std::filesystem::path& path : paths) {
        std::error_code error;
        if (!std::filesystem::is_directory(path, error)) {
            files.push_back(path);
            continue;
        }
        std::vector<std::filesystem::path> below;
        for (std::filesystem::recursive_directory_iterator entry(path, error), end; !error && entry != end;
             entry.increment(error))
            if (std::error_code none; entry->is_regular_file(none)) below.push_back(entry->path());
        if (error) throw unreadable(path, "cannot be listed: " + error.message());
        std::ranges::sort(below);
        files.insert(files.end(), below.begin(), below.end());
    }
    PrivacyReport report;
    for (const std::filesystem::path& file : files) {
        search_file(file, machine, report.findings);
        ++report.files;
    }
    return report;
}

}  // namespace palpate::archive
