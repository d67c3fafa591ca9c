// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <nlohmann/json.hpp>
#include <utility>

namespace palpate::imaging {

/// Parses JSON; the result is_discarded() where it is none, or nested more than 32 deep: copying and writing
/// such a value out would recurse as deeply.
template <typename Input>
nlohmann::json shallow_json(Input&& input) {
    constexpr int deepest = 32;
    bool deep = false;
    const auto keep = [&](int depth, nlohmann::json::parse_event_t, nlohmann::json&) {
        deep = deep || depth > deepest;
        return !deep;
    };
    nlohmann::json document = nlohmann::json::parse(std::forward<Input>(input), keep, false);
    if (deep) document = nlohmann::json(nlohmann::json::value_t::discarded);
    return document;
}

}  // namespace palpate::imaging
