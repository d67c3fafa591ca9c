// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <map>
#include <span>
#include <string>

#include "formats/asset/hdf5/hdf5_file.hpp"

namespace palpate::asset {

/// Finds every object of an HDF5 file by its absolute path, "/" included; the arrays point into `bytes`.
/// Throws InvalidInput naming `file_name` if the file is not of the plain kind (see Hdf5File).
std::map<std::string, Hdf5Object> parse_hdf5(std::span<const std::byte> bytes, const std::string& file_name);

}  // namespace palpate::asset
