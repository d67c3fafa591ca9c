// SPDX-License-Identifier: GPL-3.0-or-later
// For this folder only: the header of a NIfTI file and what it says of place.
#pragma once
#include <Eigen/Core>
#include <array>
#include <filesystem>
#include <itk_zlib.h>
#include <memory>
#include <string>

#include "tools/imaging/files/image_files.hpp"

namespace palpate::imaging {

/// A file, unpacked on the fly if it is gzip.
class NiftiStream {
  public:
    explicit NiftiStream(const std::filesystem::path& path)
        : path_(path), file_(gzopen(path.c_str(), "rb"), gzclose) {}

    /// Throws InvalidInput if fewer bytes are left.
    void read(void* to, std::size_t bytes);
    /// Reads to the end, which makes zlib check the sum of the contents; throws InvalidInput if it is wrong.
    void read_rest();

    bool packed() { return gzdirect(file_.get()) == 0; }

  private:
    std::filesystem::path path_;
    std::unique_ptr<gzFile_s, int (*)(gzFile)> file_;
};

/// The fields of either version, by the names of nifti1.h.
struct NiftiHeader {
    std::array<std::int64_t, 8> dim{};
    std::int16_t datatype = 0;
    std::array<double, 8> pixdim{};
    std::int64_t voxel_offset = 0;
    std::size_t bytes = 0;  ///< of the header itself
    double slope = 0, intercept = 0;
    int units = 0, qform_code = 0, sform_code = 0;
    Eigen::Vector3d quaternion, q_offset;
    Eigen::Matrix<double, 3, 4> sform;
    bool swapped = false;
};

/// Reads NIfTI-1 or -2 of either byte order; throws InvalidInput if the file is neither.
NiftiHeader read_nifti_header(NiftiStream& stream, const std::filesystem::path& path);

/// Maps a voxel index to RAS in the header's unit: by the transform that `frame` names ("qform", "sform"),
/// else by the one that is set; two may differ by a tenth of a voxel at the corners. Throws InvalidInput if
/// they differ more (with both), or if the named one is not set.
Eigen::Matrix<double, 3, 4> nifti_affine(const NiftiHeader& header, const std::filesystem::path& path,
                                         const NoteSink& note, const std::string& frame);

}  // namespace palpate::imaging
