// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/outputs/staged_folder.hpp"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <unistd.h>

#include "formats/model/errors.hpp"
#include "tools/cli/outputs/output_target.hpp"

namespace palpate::cli {
namespace {

namespace fs = std::filesystem;

bool is_something(const fs::path& target) {
    return fs::exists(fs::symlink_status(target)) && !(fs::is_directory(target) && fs::is_empty(target));
}

// Links followed; "out/" and "out" are one target.
fs::path place_of(const fs::path& target) {
    const fs::path place = fs::weakly_canonical(fs::absolute(target));
    return place.has_filename() ? place : place.parent_path();
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& target, bool replace) : target_(place_of(target)) {
    if (!replace && is_something(target_))
        throw InvalidInput({target.string(), "exists already", "", "choose another name or pass --force"});
    const fs::path parent = target_.parent_path();
    if (!fs::is_directory(parent))
        throw InvalidInput(
            {target.string(), "its folder does not exist", "", "make it first: mkdir -p " + parent.string()});
    remove_orphans(parent);
    staged_ = create_staged_folder(parent, target_);
}

StagedFolder::~StagedFolder() {
    std::error_code ignored;
    fs::remove_all(staged_.path, ignored);
    close(staged_.descriptor);
}

void StagedFolder::commit() {
    if (fs::exists(fs::symlink_status(target_))) {
        if (renameat2(AT_FDCWD, staged_.path.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) != 0) {
            if (errno != EINVAL && errno != ENOSYS) fail_to_write(target_, errno);
            throw InvalidInput({target_.string(), "cannot be replaced at once on this file system", "",
                                "remove it first: rm -r " + target_.string()});
        }
    } else if (rename(staged_.path.c_str(), target_.c_str()) != 0) {
        fail_to_write(target_, errno);
    }
    const int folder = open(target_.parent_path().c_str(), O_RDONLY | O_CLOEXEC);
    if (folder >= 0) {
        fsync(folder);
        close(folder);
    }
}

}  // namespace palpate::cli
