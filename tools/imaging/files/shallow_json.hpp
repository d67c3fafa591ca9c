// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <fstream>
#include <nlohmann/json.hpp>
#include <utility>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"

namespace palpate::imaging {

/// Parses JSON; the result is_discarded() where it is none, or nested more than 32 deep: copying and writing
/// such a value out would recurse as deeply.
template <typename Json = nlohmann::json, typename Input>
Json shallow_json(Input&& input) {
    constexpr int deepest = 32;
    bool deep = false;
    const auto keep = [&](int depth, typename Json::parse_event_t, Json&) {
        deep = deep || depth > deepest;
        return !deep;
    };
    Json document = Json::parse(std::forward<Input>(input), keep, false);
    if (deep) document = Json(Json::value_t::discarded);
    return document;
}

/// Reads a JSON file of 16 MiB at most, as shallow_json() does. Throws InvalidInput if it cannot be read.
template <typename Json = nlohmann::json>
Json read_json_file(const std::filesystem::path& path) {
    constexpr std::uintmax_t most_bytes = 16 << 20;
    require_small_file(path, most_bytes);
    std::ifstream stream(path, std::ios::binary);
    if (!stream)
        throw InvalidInput({path.string(), "cannot be read", "", "check that it is a file you may read"});
    return shallow_json<Json>(stream);
}

}  // namespace palpate::imaging
