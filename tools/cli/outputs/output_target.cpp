// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/outputs/output_target.hpp"

#include <atomic>
#include <cerrno>
#include <iostream>
#include <string>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "formats/model/errors.hpp"
#include "formats/model/reading/small_file.hpp"

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

[[noreturn]] void refuse(const std::filesystem::path& target, const std::string& found,
                         const std::string& expected) {
    throw InvalidInput({target.string(), found, expected, "name the file to write"});
}

std::atomic<bool> stdout_taken{false};

bool is_stdout(const std::filesystem::path& output) {
    struct stat ours {
    }, named{};
    return fstat(STDOUT_FILENO, &ours) == 0 && stat(output.c_str(), &named) == 0 &&
           ours.st_dev == named.st_dev && ours.st_ino == named.st_ino;
}

}  // namespace

OutputTarget output_target(const std::filesystem::path& named) {
    const char* const expected = "a file name or a pipe";
    if (named == "-") refuse(named, "is no file; /dev/stdout is, where it is a pipe", expected);
    std::error_code none;
    if (std::filesystem::is_fifo(named, none)) return {named, true};
    if (const std::string kind = other_kind(named); !kind.empty()) refuse(named, kind, expected);
    return {followed(named), false};
}

std::filesystem::path seekable_target(const std::filesystem::path& named) {
    const char* const expected = "a file name";
    if (named == "-") refuse(named, "is no file", expected);
    if (const std::string kind = other_kind(named); !kind.empty()) refuse(named, kind, expected);
    return followed(named);
}

void require_folder_target(const std::filesystem::path& named) {
    const auto refuse = [](const std::filesystem::path& path, const std::string& found) {
        throw InvalidInput({path.string(), found, "a folder", "name the folder to write into"});
    };
    if (named == "-") refuse(named, "is no folder");
    std::filesystem::path path = named;
    for (std::error_code none; !path.empty() && !std::filesystem::is_directory(path, none);
         path = path.parent_path()) {
        if (const std::string kind = other_kind(path); !kind.empty()) refuse(path, kind);
        if (std::filesystem::is_regular_file(path, none)) refuse(path, "is a file");
        if (std::filesystem::is_symlink(path, none)) refuse(path, "is a link that leads nowhere");
    }
}

void take_stdout_for(const std::filesystem::path& output) {
    if (is_stdout(output)) take_stdout_as(output.string());
}

void take_stdout_as(const std::string& name) {
    if (stdout_taken.exchange(true))
        throw UsageError({name, "another output goes to stdout as well", "", "name a file for one of them"});
}

bool stdout_is_taken() {
    return stdout_taken.load();
}

void flush_stdout() {
    if (!std::cout.flush()) fail_to_write("stdout", errno != 0 ? errno : EIO);
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
    return file.has_parent_path() ? file.parent_path() : ".";
}

void fail_to_write(const std::filesystem::path& target, int error) {
    throw SystemFailure({target.string(), "could not be written: " + std::generic_category().message(error),
                         "", "check free space and permissions of its folder"});
}

}  // namespace palpate::cli
