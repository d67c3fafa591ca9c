// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <initializer_list>
#include <nlohmann/json.hpp>
#include <string>
#include <vector>

#include "formats/model/errors.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/item_list.hpp"

namespace palpate::cli {

/// Throws UsageError naming the key if `item` has one that is none of `known`.
void refuse_other_keys(const nlohmann::ordered_json& item, std::initializer_list<const char*> known);

/// Binds `items` to an option that `from_word` reads on the command line ("liver:6.3,0.45") and the JSON
/// conversions of T (to_json and from_json for nlohmann::ordered_json) in request files. `items` must outlive
/// the command. Reading throws UsageError naming the word or object at fault.
template <typename T>
ItemList item_list(std::vector<T>& items, T (*from_word)(const std::string&)) {
    const auto read = [&items, from_word](const std::vector<std::string>& words) {
        items.clear();
        for (const std::string& word : words) try {
                items.push_back(word.starts_with('{') ? nlohmann::ordered_json::parse(word).get<T>()
                                                      : from_word(word));
            } catch (const nlohmann::ordered_json::exception& error) {
                throw UsageError({word, error.what(), "", "see --help"});
            }
    };
    return {read, [&items] { return nlohmann::ordered_json(items); }};
}

/// Writes a request as `--request` of its command reads it; declare(Command&, Request&) binds its fields.
template <typename Request>
nlohmann::ordered_json to_request(const Request& request) {
    Command command({});
    Request bound;
    declare(command, bound);
    bound = request;
    return command.request();
}

}  // namespace palpate::cli
