// SPDX-License-Identifier: Apache-2.0
#include "formats/model/reading/small_file.hpp"

#include <system_error>

#include "formats/model/errors.hpp"

namespace palpate {

std::string other_kind(const std::filesystem::path& path) {
    using std::filesystem::file_type;
    std::error_code none;
    switch (std::filesystem::status(path, none).type()) {
        case file_type::directory:
            return "is a folder";
        case file_type::character:
        case file_type::block:
            return "is a device";
        case file_type::socket:
            return "is a socket";
        case file_type::fifo:
            return "is a pipe";
        default:
            return "";
    }
}

void require_small_file(const std::filesystem::path& path, std::uintmax_t most) {
    if (const std::string kind = other_kind(path); !kind.empty())
        throw InvalidInput({path.string(), kind, "a file", "check the path"});
    std::error_code none;
    if (!std::filesystem::exists(path, none)) return;
    if (const auto size = std::filesystem::file_size(path, none); size > most)
        throw InvalidInput({path.string(), "has " + std::to_string(size) + " bytes",
                            std::to_string(most) + " at most", "check that it is the file you mean"});
}

}  // namespace palpate
