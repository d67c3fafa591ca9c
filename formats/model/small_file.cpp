// SPDX-License-Identifier: Apache-2.0
#include "formats/model/small_file.hpp"

#include <string>

#include "formats/model/errors.hpp"

namespace palpate {

void require_small_file(const std::filesystem::path& path, std::uintmax_t most) {
    std::error_code none;
    if (!std::filesystem::exists(path, none)) return;
    if (!std::filesystem::is_regular_file(path, none))
        throw InvalidInput({path.string(), "is no file", "", "check the path"});
    if (const auto size = std::filesystem::file_size(path, none); size > most)
        throw InvalidInput({path.string(), "has " + std::to_string(size) + " bytes",
                            std::to_string(most) + " at most", "check that it is the file you mean"});
}

}  // namespace palpate
