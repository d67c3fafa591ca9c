// SPDX-License-Identifier: Apache-2.0
#include "runtime/visual/controls/free_path.hpp"

#include <string_view>
#include <system_error>

namespace palpate::visual {
namespace {

std::string plain_name(const std::string& case_name) {
    constexpr std::string_view plain = "abcdefghijklmnopqrstuvwxyzABCDEFGHIJKLMNOPQRSTUVWXYZ0123456789-_";
    std::string name = case_name;
    for (char& c : name)
        if (plain.find(c) == std::string_view::npos) c = '_';
    return name;
}

}  // namespace

std::filesystem::path free_path(const std::filesystem::path& folder, const std::string& case_name,
                                const std::string& extension) {
    const std::string name = plain_name(case_name);
    for (int n = 1;; ++n) {
        const auto path = folder / ("palpate-" + name + "-" + std::to_string(n) + extension);
        std::error_code nothing_to_see;
        if (!std::filesystem::exists(path, nothing_to_see)) return path;
    }
}

}  // namespace palpate::visual
