// SPDX-License-Identifier: Apache-2.0
#include "runtime/doctor/machine.hpp"

#include <fstream>

namespace palpate::doctor {

std::filesystem::path in_root(const Machine& machine, const std::filesystem::path& path) {
    return machine.root / path.relative_path();
}

std::optional<std::string> text_of(const Machine& machine, const std::filesystem::path& path) {
    constexpr std::streamsize most = 1 << 20;
    const std::filesystem::path place = in_root(machine, path);
    std::error_code error;
    if (!std::filesystem::is_regular_file(place, error)) return std::nullopt;
    std::ifstream file(place, std::ios::binary);
    if (!file) return std::nullopt;
    std::string text(static_cast<std::size_t>(most), '\0');
    file.read(text.data(), most);
    text.resize(file.gcount());
    while (!text.empty() && (text.back() == '\n' || text.back() == ' ')) text.pop_back();
    return text;
}

std::string variable(const Machine& machine, const std::string& name) {
    const auto found = machine.environment.find(name);
    return found == machine.environment.end() ? "" : found->second;
}

}  // namespace palpate::doctor
