// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <nlohmann/json.hpp>

#include "formats/model/body.hpp"

namespace palpate::inspection {

/// A body in figures: nodes, triangles, compliance.
nlohmann::ordered_json row_of(const RigidBody& body);
nlohmann::ordered_json row_of(const DeformableBody& body);

/// Appends a body's regions with their materials and volumes.
void add_regions(nlohmann::ordered_json& rows, const DeformableBody& body);

/// A body's certificate with what it is of.
nlohmann::ordered_json certificate_row(const DeformableBody& body);

/// Everything that an asset holds, in figures. Throws as read_asset() does.
nlohmann::ordered_json asset_json(const std::filesystem::path& asset);

}  // namespace palpate::inspection
