// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/request_format.hpp"

#include <nlohmann/json.hpp>

#include "formats/model/errors.hpp"
#include "formats/model/label_map.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/items.hpp"

namespace palpate::cli {
namespace {

using Json = nlohmann::ordered_json;

std::string hint_for(const std::string& key, const std::vector<std::string>& known) {
    std::string hint;
    for (const std::string& near : nearest_names(key, known))
        hint += (hint.empty() ? "did you mean " : ", ") + near;
    return hint;
}

// A text as it is, anything else as JSON writes it.
std::string word_of(const Json& value) {
    return value.is_string() ? value.get<std::string>() : value.dump();
}

CLI::ConfigItem item_of(const Parameter& parameter, const Json& value) {
    CLI::ConfigItem item;
    item.name = parameter.option.handle().get_single_name();
    if (value.is_array())
        for (const Json& element : value) item.inputs.push_back(word_of(element));
    else
        item.inputs.push_back(word_of(value));
    return item;
}

}  // namespace

void refuse_other_keys(const Json& item, std::initializer_list<const char*> known) {
    for (const auto& [key, value] : item.items())
        if (std::ranges::find(known, key) == known.end())
            throw UsageError({item.dump(), "its key '" + key + "' is not known", "",
                              hint_for(key, {known.begin(), known.end()})});
}

std::vector<CLI::ConfigItem> RequestFormat::from_config(std::istream& stream) const {
    const Json request = Json::parse(stream, nullptr, false);
    if (!request.is_object())
        throw InvalidInput({"the request", "is no JSON object", "{\"key\": value, ...}", ""});
    std::vector<CLI::ConfigItem> items;
    for (const auto& [key, value] : request.items()) {
        const auto& parameters = command_.parameters();
        const auto found = std::ranges::find(parameters, key, &Parameter::key);
        if (found == parameters.end()) {
            std::vector<std::string> known;
            for (const Parameter& parameter : parameters) known.push_back(parameter.key);
            throw InvalidInput(
                {"the request", "its key '" + key + "' is not known", "", hint_for(key, known)});
        }
        items.push_back(item_of(*found, value));
    }
    return items;
}

}  // namespace palpate::cli
