// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/outputs/staged_folder.hpp"

#include <cerrno>
#include <cstdio>
#include <fcntl.h>
#include <sys/file.h>
#include <sys/stat.h>
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

// Held on a staged folder, so that no other process takes it for one that a killed process left.
int locked(const fs::path& folder, const fs::path& target) {
    const int lock = open(folder.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (lock < 0) fail_to_write(target, errno);
    if (flock(lock, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        close(lock);
        throw InvalidInput({target.string(), "is being written by another process", "", "wait for it"});
    }
    return lock;
}

}  // namespace

StagedFolder::StagedFolder(const fs::path& target, bool replace) : target_(place_of(target)) {
    if (!replace && is_something(target_))
        throw InvalidInput({target.string(), "exists already", "", "choose another name or pass --force"});
    const fs::path parent = target_.parent_path();
    if (!fs::is_directory(parent))
        throw InvalidInput(
            {target.string(), "its folder does not exist", "", "make it first: mkdir -p " + parent.string()});
    staged_ = parent / (".part-" + target_.filename().string());
    if (mkdir(staged_.c_str(), 0777) != 0 && errno != EEXIST) fail_to_write(target, errno);
    lock_ = locked(staged_, target);
    for (const auto& left : fs::directory_iterator(staged_)) fs::remove_all(left.path());
}

StagedFolder::~StagedFolder() {
    discard();
}

void StagedFolder::discard() {
    std::error_code ignored;
    if (!staged_.empty()) fs::remove_all(staged_, ignored);
    close(lock_);
    if (replaced_ >= 0) close(replaced_);
}

void StagedFolder::commit() {
    if (fs::exists(fs::symlink_status(target_))) {
        replaced_ = locked(target_, target_);  // it is the staged one in a moment
        if (renameat2(AT_FDCWD, staged_.c_str(), AT_FDCWD, target_.c_str(), RENAME_EXCHANGE) != 0) {
            if (errno != EINVAL && errno != ENOSYS) fail_to_write(target_, errno);
            throw InvalidInput({target_.string(), "cannot be replaced at once on this file system", "",
                                "remove it first: rm -r " + target_.string()});
        }
    } else if (rename(staged_.c_str(), target_.c_str()) != 0) {
        fail_to_write(target_, errno);
    }
    const int folder = open(target_.parent_path().c_str(), O_RDONLY | O_CLOEXEC);
    if (folder >= 0) {
        fsync(folder);
        close(folder);
    }
    if (replaced_ < 0) staged_.clear();
}

}  // namespace palpate::cli
