// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <optional>
#include <string>

#include "formats/asset/hdf5/hdf5_file.hpp"
#include "formats/asset/hdf5/hdf5_writer.hpp"
#include "formats/model/body.hpp"

namespace palpate::asset {

/// What is for the eye alone in formats/asset/SPEC.md, all of it optional: the scan and the bodies' colours.

/// What must hold of a scan: 1 to 4096 voxels along each axis and 64 Mi of them at most, as many values;
/// finite places, spacings of 0.001 to 100 mm, orthonormal directions. Throws InvalidInput whose culprit
/// starts with `where`.
void check_scan(const Scan& scan, const std::string& where);

void write_scan(Hdf5Writer& writer, const std::string& path, const Scan& scan);
/// None in a file without it; throws InvalidInput as check_scan() does, before anything is allocated.
std::optional<Scan> read_scan(const Hdf5File& file, const std::string& path);

/// The colour of a body, if it has one of its own.
void write_colour(Hdf5Writer& writer, const std::string& path, const std::optional<Colour>& colour);
std::optional<Colour> read_colour(const Hdf5File& file, const std::string& path);

/// The colours of a body's regions, if any has one of its own.
void write_region_colours(Hdf5Writer& writer, const std::string& path,
                          const std::vector<RegionColour>& colours);
std::vector<RegionColour> read_region_colours(const Hdf5File& file, const std::string& path);

}  // namespace palpate::asset
