// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/folder_lock.hpp"

#include <cerrno>
#include <fcntl.h>
#include <system_error>
#include <unistd.h>

#include "formats/model/errors.hpp"

namespace palpate::case_builder {
namespace {

int opened(const std::filesystem::path& folder) {
    const std::filesystem::path path = folder / "lock";
    const int file = open(path.c_str(), O_RDWR | O_CREAT | O_CLOEXEC, 0666);
    if (file < 0)
        throw SystemFailure({path.string(), "cannot be written: " + std::generic_category().message(errno),
                             "", "check the folder's permissions and space"});
    return file;
}

// One byte of the file for each name, by the file's description and not by the process, so that a second
// description in this process waits too. Ranges work over network file systems where whole files may not.
struct flock range_of(const std::string& what) {
    std::uint64_t hash = 1469598103934665603U;  // FNV-1a
    for (const char letter : what) hash = (hash ^ static_cast<unsigned char>(letter)) * 1099511628211U;
    struct flock range {};
    range.l_type = F_WRLCK;
    range.l_whence = SEEK_SET;
    range.l_start = static_cast<off_t>(hash % (1U << 30U));
    range.l_len = 1;
    return range;
}

[[noreturn]] void refuse(const std::filesystem::path& folder, int error) {
    throw SystemFailure({folder.string(), "cannot be locked: " + std::generic_category().message(error),
                         "a file system with locks, so that no two builds mix their files",
                         "choose a folder on another one, such as a local disk"});
}

}  // namespace

FolderLock::FolderLock(const std::filesystem::path& folder, const std::string& what, Hold hold)
    : file_(opened(folder)) {
    struct flock range = range_of(what);
    if (hold == Hold::shared) range.l_type = F_RDLCK;
    while (fcntl(file_, F_OFD_SETLKW, &range) != 0) {
        if (errno == EINTR) continue;
        const int error = errno;
        close(file_);
        refuse(folder, error);
    }
}

FolderLock::~FolderLock() {
    close(file_);
}

bool FolderLock::held_by_another(const std::filesystem::path& folder, const std::string& what) {
    const int file = opened(folder);
    struct flock range = range_of(what);
    const int error = fcntl(file, F_OFD_GETLK, &range) == 0 ? 0 : errno;
    close(file);
    if (error != 0) refuse(folder, error);
    return range.l_type != F_UNLCK;
}

}  // namespace palpate::case_builder
