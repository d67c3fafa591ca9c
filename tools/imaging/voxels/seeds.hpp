// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <Eigen/Core>
#include <filesystem>
#include <span>
#include <string>
#include <vector>

namespace palpate::imaging {

/// A point that a person placed in a structure.
struct Seed {
    std::string label;         ///< name of the structure
    Eigen::Vector3d p_P;       ///< LPS, mm
    std::string written = {};  ///< the label as the file has it, with its number; empty if it has none
};

/// Reads point lists of 3D Slicer: .mrk.json (every list in the file) or .fcsv. RAS files become LPS. A
/// seed's label is its point's label without the number that Slicer appends ("liver-2" is "liver", but
/// "vein_2" stays); a point without a label takes its list's name, or else the file's. Points that were never
/// placed are left out. Throws InvalidInput if the file is missing, damaged, of another ending, in another
/// coordinate system (voxel indices) or unit than mm, or holds no point. Source: Slicer's markups
/// schema 1.0.3 and its fcsv format (CoordinateSystem 0 is RAS, 1 is LPS).
std::vector<Seed> read_seeds(const std::filesystem::path& path);

/// Writes one list that 3D Slicer opens (.mrk.json), in LPS, points in the given order. A label that ends
/// like a numbered one ("x-2") gets its point's number behind, so that it is read back whole. Throws
/// SystemFailure if the file could not be written whole.
void write_seeds(const std::filesystem::path& path, std::span<const Seed> seeds);

/// Tells whether two labels are the same, ignoring case.
bool same_label(const std::string& a, const std::string& b);

/// Those of `seeds` whose label is `name` (ignoring case), or else those written so in their file, number
/// included ("x-2"), or all if they share a single label.
/// Throws InvalidInput naming `culprit` and the labels there are if neither holds.
std::vector<Seed> seeds_of(std::span<const Seed> seeds, const std::string& name, const std::string& culprit);

}  // namespace palpate::imaging
