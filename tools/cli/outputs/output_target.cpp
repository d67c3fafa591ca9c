// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/outputs/output_target.hpp"

#include <string>
#include <system_error>

#include "formats/model/errors.hpp"

namespace palpate::cli {
namespace {

// The file that a target names, links followed, also to what is not there yet.
std::filesystem::path followed(std::filesystem::path target) {
    constexpr int most_links = 40;  // as Linux
    for (int links = 0; std::filesystem::is_symlink(target); ++links) {
        if (links == most_links)
            throw InvalidInput(
                {target.string(), "is a link that leads to itself", "a file name", "remove the link"});
        target = folder_of(target) / std::filesystem::read_symlink(target);
    }
    return target;
}

// Throws unless a target is a file, a pipe or nothing yet; says whether it is a pipe.
bool is_pipe(const std::filesystem::path& target) {
    const auto refuse = [&](const std::string& found) {
        throw InvalidInput({target.string(), found, "a file name or a pipe", "name the file to write"});
    };
    if (target == "-") refuse("is no file; /dev/stdout is, where it is a pipe");
    using std::filesystem::file_type;
    std::error_code error;
    switch (std::filesystem::status(target, error).type()) {
        case file_type::directory:
            refuse("is a folder");
            break;
        case file_type::character:
        case file_type::block:
            refuse("is a device");
            break;
        case file_type::socket:
            refuse("is a socket");
            break;
        case file_type::fifo:
            return true;
        default:
            break;
    }
    return false;
}

}  // namespace

OutputTarget output_target(const std::filesystem::path& named) {
    return is_pipe(named) ? OutputTarget{named, true} : OutputTarget{followed(named), false};
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
    return file.has_parent_path() ? file.parent_path() : ".";
}

void fail_to_write(const std::filesystem::path& target, int error) {
    throw SystemFailure({target.string(), "could not be written: " + std::generic_category().message(error),
                         "", "check free space and permissions of its folder"});
}

}  // namespace palpate::cli
