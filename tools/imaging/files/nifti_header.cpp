// SPDX-License-Identifier: GPL-3.0-or-later
// Byte offsets: nifti1.h and nifti2.h (NIH, 2003, 2011).
#include "tools/imaging/files/nifti_header.hpp"

#include <Eigen/Geometry>
#include <algorithm>
#include <bit>
#include <cmath>
#include <cstring>
#include <fmt/format.h>

#include "formats/model/errors.hpp"

namespace palpate::imaging {
namespace {

static_assert(std::endian::native == std::endian::little);

// Corners of the image may differ by this many voxels between the two transforms.
constexpr double agreement_voxels = 0.1;

template <typename T>
T field(const std::string& bytes, std::size_t offset, bool swapped) {
    std::array<std::byte, sizeof(T)> raw{};
    std::memcpy(raw.data(), bytes.data() + offset, sizeof(T));
    if (swapped) std::ranges::reverse(raw);
    return std::bit_cast<T>(raw);
}

// Both versions hold the same fields, in other places and widths.
template <typename Integer, typename Real, typename Code>
NiftiHeader parse(const std::string& bytes, bool swapped, std::size_t dim, std::size_t datatype,
                  std::size_t pixdim, std::size_t slope, std::size_t units, std::size_t codes) {
    NiftiHeader header;
    header.swapped = swapped;
    header.bytes = bytes.size();
    const auto real = [&](std::size_t at) { return double{field<Real>(bytes, at, swapped)}; };
    for (std::size_t i = 0; i < 8; ++i) {
        header.dim[i] = field<Integer>(bytes, dim + i * sizeof(Integer), swapped);
        header.pixdim[i] = real(pixdim + i * sizeof(Real));
    }
    header.datatype = field<std::int16_t>(bytes, datatype, swapped);
    header.slope = real(slope);
    header.intercept = real(slope + sizeof(Real));
    header.units = static_cast<unsigned char>(bytes[units]);
    header.qform_code = static_cast<int>(field<Code>(bytes, codes, swapped));
    header.sform_code = static_cast<int>(field<Code>(bytes, codes + sizeof(Code), swapped));
    const std::size_t quaternion = codes + 2 * sizeof(Code);
    for (std::size_t i = 0; i < 3; ++i) {
        const auto row = static_cast<Eigen::Index>(i);
        header.quaternion[row] = real(quaternion + i * sizeof(Real));
        header.q_offset[row] = real(quaternion + (3 + i) * sizeof(Real));
        for (std::size_t j = 0; j < 4; ++j)
            header.sform(row, static_cast<Eigen::Index>(j)) =
                real(quaternion + (6 + 4 * i + j) * sizeof(Real));
    }
    return header;
}

using Affine = Eigen::Matrix<double, 3, 4>;

// nifti1.h, method 2: a rotation by the quaternion, after mirroring the third axis if qfac is -1.
Affine qform_of(const NiftiHeader& header) {
    const double length = std::min(header.quaternion.norm(), 1.0);
    const Eigen::Quaterniond rotation(std::sqrt(1 - length * length), header.quaternion[0],
                                      header.quaternion[1], header.quaternion[2]);
    Affine affine;
    affine.leftCols<3>() = rotation.normalized().toRotationMatrix() *
                           Eigen::Vector3d(header.pixdim[1], header.pixdim[2],
                                           header.pixdim[3] * (header.pixdim[0] < 0 ? -1 : 1))
                               .asDiagonal();
    affine.col(3) = header.q_offset;
    return affine;
}

// The largest distance between corners of the image under two transforms, in the smallest voxel edge.
double disagreement_voxels(const Affine& a, const Affine& b, const NiftiHeader& header) {
    double largest = 0;
    for (int corner = 0; corner < 8; ++corner) {
        Eigen::Vector4d index(0, 0, 0, 1);
        for (unsigned axis = 0; axis < 3; ++axis)
            if (corner >> axis & 1) index[axis] = static_cast<double>(header.dim[axis + 1] - 1);
        largest = std::max(largest, (a * index - b * index).norm());
    }
    return largest / b.leftCols<3>().colwise().norm().minCoeff();
}

std::string rows_of(const Affine& affine) {
    std::string text;
    for (int row = 0; row < 3; ++row)
        text += fmt::format("{}[{:.6g} {:.6g} {:.6g} {:.6g}]", row ? " " : "", affine(row, 0), affine(row, 1),
                            affine(row, 2), affine(row, 3));
    return text;
}

}  // namespace

void NiftiStream::read(void* to, std::size_t bytes) {
    char* target = static_cast<char*>(to);
    while (bytes > 0) {
        const auto part = static_cast<unsigned>(std::min<std::size_t>(bytes, std::size_t{1} << 28));
        const int got = file_ ? gzread(file_.get(), target, part) : -1;
        if (got <= 0)
            throw InvalidInput({path_.string(), "holds fewer voxels than its header claims", "",
                                "check that the file is whole"});
        target += got;
        bytes -= static_cast<std::size_t>(got);
    }
}

void NiftiStream::read_rest() {
    std::array<char, 4096> rest{};
    int got = 1;
    while (got > 0) got = gzread(file_.get(), rest.data(), rest.size());
    if (got < 0)
        throw InvalidInput({path_.string(), "is damaged: its checksum does not fit its contents", "",
                            "copy or convert the file again"});
}

NiftiHeader read_nifti_header(NiftiStream& stream, const std::filesystem::path& path) {
    std::string bytes(348, '\0');
    stream.read(bytes.data(), 348);
    const auto first = field<std::int32_t>(bytes, 0, false),
               first_swapped = field<std::int32_t>(bytes, 0, true);
    if (first == 348 || first_swapped == 348) {
        const bool swapped = first != 348;
        if (bytes.substr(344, 3) == "n+1") {
            NiftiHeader header =
                parse<std::int16_t, float, std::int16_t>(bytes, swapped, 40, 70, 76, 112, 123, 252);
            const float offset = field<float>(bytes, 108, swapped);
            header.voxel_offset =
                std::isfinite(offset) ? static_cast<std::int64_t>(std::clamp(offset, 0.F, 1e9F)) : 0;
            return header;
        }
    } else if (first == 540 || first_swapped == 540) {
        const bool swapped = first != 540;
        bytes.resize(540);
        stream.read(bytes.data() + 348, 540 - 348);
        if (bytes.substr(4, 3) == "n+2") {
            const std::size_t units = swapped ? 503 : 500;
            NiftiHeader header =
                parse<std::int64_t, double, std::int32_t>(bytes, swapped, 16, 12, 104, 176, units, 344);
            header.voxel_offset = field<std::int64_t>(bytes, 168, swapped);
            return header;
        }
    }
    throw InvalidInput({path.string(), "is not a NIfTI file of one piece", "a header of NIfTI-1 or NIfTI-2",
                        "convert an Analyze or .hdr/.img pair to .nii.gz"});
}

Affine nifti_affine(const NiftiHeader& header, const std::filesystem::path& path, const NoteSink& note,
                    const std::string& frame) {
    const Affine qform = qform_of(header);
    if (frame == "qform" || frame == "sform") {
        if ((frame == "qform" ? header.qform_code : header.sform_code) > 0)
            return frame == "qform" ? qform : header.sform;
        throw InvalidInput({path.string(), "has no " + frame, "", "leave the choice of the frame out"});
    }
    if (!frame.empty()) throw UsageError({"NIfTI frame", "'" + frame + "'", "qform or sform", ""});
    if (header.qform_code > 0 && header.sform_code > 0) {
        const double voxels = disagreement_voxels(qform, header.sform, header);
        if (!(voxels <= agreement_voxels))
            throw InvalidInput(
                {path.string(),
                 fmt::format("qform {} and sform {} (RAS mm) are both set and disagree by {:.3g} voxels",
                             rows_of(qform), rows_of(header.sform), voxels),
                 fmt::format("{} at most", agreement_voxels),
                 "choose with 'palpate import ... --nifti-frame qform' or '... --nifti-frame sform'"});
    }
    if (header.sform_code > 0) return header.sform;
    if (header.qform_code > 0) return qform;
    // nifti1.h, method 1.
    if (note) note("the header sets neither qform nor sform; axes taken as right, anterior, superior");
    Affine affine = Affine::Zero();
    for (unsigned axis = 0; axis < 3; ++axis) affine(axis, axis) = header.pixdim[axis + 1];
    return affine;
}

}  // namespace palpate::imaging
