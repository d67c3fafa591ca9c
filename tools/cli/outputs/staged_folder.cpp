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
    require_folder_target(target);
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
    for (const auto& entry : fs::recursive_directory_iterator(staged_.path))
        flush_to_disk(entry.path(), target_);
    flush_to_disk(staged_.path, target_);
    if (fs::exists(fs::symlink_status(target_))) {
        if (renameat2(AT_FDCWD, staged_.path.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) != 0) {
            if (errno != EINVAL && errno != ENOSYS) fail_to_write(target_, errno);
            throw InvalidInput({target_.string(), "cannot be replaced at once on this file system", "",
                                "remove it first: rm -r " + target_.string()});
        }
    } else if (rename(staged_.path.c_str(), target_.c_str()) != 0) {
        fail_to_write(target_, errno);
    }
    flush_to_disk(target_.parent_path(), target_);
}

}  // namespace palpate::cli
