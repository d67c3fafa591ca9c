// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/outputs/staged_folder.hpp"

#include <cerrno>
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
    lock_ = open(staged_.c_str(), O_RDONLY | O_DIRECTORY | O_NOFOLLOW | O_CLOEXEC);
    if (lock_ < 0) fail_to_write(target, errno);
    if (flock(lock_, LOCK_EX | LOCK_NB) != 0 && errno == EWOULDBLOCK) {
        close(lock_);
        throw InvalidInput({target.string(), "is being written by another process", "", "wait for it"});
    }
    for (const auto& left : fs::directory_iterator(staged_)) fs::remove_all(left.path());
}

StagedFolder::~StagedFolder() {
    std::error_code ignored;
    if (!staged_.empty()) fs::remove_all(staged_, ignored);
    close(lock_);
}

void StagedFolder::commit() {
    const fs::path old = target_.parent_path() / (".old-" + target_.filename().string());
    std::error_code failed, ignored;
    fs::remove_all(old, ignored);
    const bool replaced = fs::exists(fs::symlink_status(target_));
    if (replaced) fs::rename(target_, old, failed);
    if (!failed) fs::rename(staged_, target_, failed);
    if (failed) {
        if (replaced) fs::rename(old, target_, ignored);
        fail_to_write(target_, failed.value());
    }
    staged_.clear();
    const int folder = open(target_.parent_path().c_str(), O_RDONLY | O_CLOEXEC);
    if (folder >= 0) {
        fsync(folder);
        close(folder);
    }
    fs::remove_all(old, ignored);
}

}  // namespace palpate::cli
