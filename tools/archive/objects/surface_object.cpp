// SPDX-License-Identifier: GPL-3.0-or-later
// DCMTK's headers first: its configuration macros must not be seen twice.
#include <Eigen/Geometry>
#include <bit>
#include <cstring>
#include <fmt/format.h>
#include <span>

#include "formats/asset/hdf5/digest.hpp"
#include "tools/archive/objects/dicom_writing.hpp"
#include "tools/archive/objects/placeholders.hpp"

namespace palpate::archive {
namespace {

// Little-endian, four bytes.
void append(std::vector<unsigned char>& bytes, std::uint32_t value) {
    for (unsigned i = 0; i < 4; ++i) bytes.push_back(static_cast<unsigned char>(value >> (8 * i) & 0xFFU));
}

void append(std::vector<unsigned char>& bytes, const Eigen::Vector3f& vector) {
    for (const float value : vector) append(bytes, std::bit_cast<std::uint32_t>(value));
}

}  // namespace

std::vector<unsigned char> binary_stl(const TriangleMesh& surface) {
    const std::string header = "Palpate SPACE=LPS unit=mm";
    std::vector<unsigned char> bytes(header.begin(), header.end());
    bytes.resize(80, ' ');
    append(bytes, static_cast<std::uint32_t>(surface.triangles.size()));
    for (const Triangle& triangle : surface.triangles) {
        const Eigen::Vector3d &a = surface.vertices[triangle[0]], &b = surface.vertices[triangle[1]],
                              &c = surface.vertices[triangle[2]];
        const Eigen::Vector3d normal = (b - a).cross(c - a).normalized();
        for (const Eigen::Vector3d& vector : {normal, a, b, c}) append(bytes, vector.cast<float>().eval());
        bytes.push_back(0);
        bytes.push_back(0);
    }
    return bytes;
}

void write_surface_object(const std::filesystem::path& path, const TriangleMesh& surface,
                          const std::string& title, const Filing& filing, const std::string& culprit) {
    require_short_text(title, "its title is", culprit);
    if (filing.reference) require_inside(surface.vertices, *filing.reference, culprit);
    std::vector<unsigned char> stl = binary_stl(surface);
    std::string seed = fmt::format("surface {} {}\n", filing.version, title);
    if (filing.reference) seed += fmt::format("{} {}\n", filing.reference->series_uid, filing.identity);
    const std::string digest = asset::sha256(seed + asset::sha256(std::as_bytes(std::span(stl))));
    DcmFileFormat file;
    DcmDataset& data = *file.getDataset();
    put_header(data, filing, digest, UID_EncapsulatedSTLStorage, "M3D", surface_series);
    if (filing.reference) add_instances(data, DCM_SourceInstanceSequence, *filing.reference);
    put(data, DCM_AcquisitionDateTime, "");
    put(data, DCM_BurnedInAnnotation, "NO");
    put(data, DCM_DocumentTitle, title);
    const SegmentCodes codes = codes_of(title);
    if (codes.known)
        add_code(data, DCM_ConceptNameCodeSequence, codes.type);
    else
        data.insertEmptyElement(DCM_ConceptNameCodeSequence);
    add_code(data, DCM_MeasurementUnitsCodeSequence, {"mm", "UCUM", "mm"});
    put(data, DCM_MIMETypeOfEncapsulatedDocument, "model/stl");
    data.putAndInsertUint32(DCM_EncapsulatedDocumentLength, static_cast<Uint32>(stl.size()));
    stl.resize((stl.size() + 1) / 2 * 2, 0);  // of even length
    data.putAndInsertUint8Array(DCM_EncapsulatedDocument, stl.data(), stl.size());
    save_object(path, file);
}

}  // namespace palpate::archive
