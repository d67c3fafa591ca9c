// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/outputs/staging.hpp"

#include <array>
#include <cerrno>
#include <cstdio>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <functional>
#include <map>
#include <optional>
#include <string>
#include <sys/file.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "tools/cli/outputs/output_target.hpp"

namespace palpate::cli {
namespace {

// Tells machines that share a folder apart: a lock of one may say nothing to another.
const std::string& machine() {
    static const std::string name = [] {
        std::string id;
        std::getline(std::ifstream("/etc/machine-id"), id);
        std::array<char, 256> host{};
        if (id.empty() && gethostname(host.data(), host.size() - 1) == 0) id = host.data();
        std::array<char, 9> digits{};
        std::snprintf(digits.data(), digits.size(), "%08zx", std::hash<std::string>{}(id)&0xFFFFFFFFU);
        return std::string(digits.data());
    }();
    return name;
}

// Of what this machine's processes stage: ".part-1a2b3c4d-4711.0-liver.vtkhdf" is the first of process 4711.
std::string staged_prefix() {
    return ".part-" + machine() + "-";
}

std::string staged_prefix(int attempt) {
    return staged_prefix() + std::to_string(getpid()) + "." + std::to_string(attempt) + "-";
}

enum class Lock { ours, of_another, unknown };

// Who holds this lock on what is staged is still at work on it; the system lets go of it with the process,
// however that ends. Of a file it is on one byte that none has, for a lock may keep a library's own
// descriptor from writing; a folder, which nobody opens for writing, has no bytes to lock. Unknown on file
// systems without locks.
Lock lock(int file, bool is_folder) {
    struct flock byte {};
    byte.l_type = F_WRLCK;
    byte.l_whence = SEEK_SET;
    byte.l_start = off_t{1} << 62;
    byte.l_len = 1;
    if ((is_folder ? flock(file, LOCK_EX | LOCK_NB) : fcntl(file, F_OFD_SETLK, &byte)) == 0)
        return Lock::ours;
    return errno == EAGAIN || errno == EACCES ? Lock::of_another : Lock::unknown;
}

bool is_still(int file, const std::filesystem::path& path) {
    struct stat opened {
    }, named{};
    return fstat(file, &opened) == 0 && lstat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}

int create_file(const std::filesystem::path& path, mode_t mode) {
    return open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, mode);
}

int create_folder(const std::filesystem::path& path) {
    if (mkdir(path.c_str(), 0777) != 0) return -1;
    const int folder = open(path.c_str(), O_RDONLY | O_DIRECTORY | O_CLOEXEC | O_NOFOLLOW);
    const int error = errno;
    if (folder < 0) rmdir(path.c_str());
    errno = error;
    return folder;
}

// The target that each file without a name is for, by its path, for messages.
std::map<std::string, std::string>& targets() {
    static std::map<std::string, std::string> known;
    return known;
}

constexpr const char* descriptors = "/proc/self/fd/";

// Nothing where the file system has no such files, or no /proc gives them a path.
std::optional<Staged> create_nameless(const std::filesystem::path& folder,
                                      const std::filesystem::path& target, mode_t mode) {
    const int file = open(folder.c_str(), O_TMPFILE | O_RDWR | O_CLOEXEC, mode);
    if (file < 0) return std::nullopt;
    const std::string path = descriptors + std::to_string(file);
    if (access(path.c_str(), F_OK) != 0 || lock(file, false) == Lock::of_another) {
        close(file);
        return std::nullopt;
    }
    targets()[path] = target.string();
    return Staged{file, path, false};
}

// Another process that looks for orphans may be quicker with the lock, or even have removed a folder before
// it is open; then under another name.
template <typename Create>
Staged create_named(const std::filesystem::path& folder, const std::filesystem::path& target, bool is_folder,
                    const Create& create) {
    for (int attempt = 0;; ++attempt) {
        const auto path = staged_name(folder, target, attempt);
        const int file = create(path);
        if (file < 0 && ((errno != EEXIST && errno != ENOENT) || attempt == most_attempts))
            fail_to_write(target, errno);
        if (file < 0) continue;
        if (lock(file, is_folder) != Lock::of_another && is_still(file, path)) return {file, path};
        close(file);
    }
}

}  // namespace

void remove_orphans(const std::filesystem::path& folder) {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        const bool is_folder = entry.is_directory(ignored);
        if (!entry.path().filename().string().starts_with(staged_prefix()) ||
            (!is_folder && !entry.is_regular_file(ignored)) || entry.is_symlink(ignored))
            continue;
        const int file = open(entry.path().c_str(), (is_folder ? O_RDONLY : O_RDWR) | O_CLOEXEC | O_NOFOLLOW);
        if (file < 0) continue;
        if (lock(file, is_folder) == Lock::ours && is_still(file, entry.path()))
            std::filesystem::remove_all(entry.path(), ignored);
        close(file);
    }
}

Staged create_staged(const std::filesystem::path& folder, const std::filesystem::path& target,
                     bool is_private) {
    const mode_t mode = is_private ? 0600 : 0666;
    if (const auto nameless = create_nameless(folder, target, mode)) return *nameless;
    return create_named(folder, target, false,
                        [mode](const std::filesystem::path& path) { return create_file(path, mode); });
}

Staged create_staged_folder(const std::filesystem::path& folder, const std::filesystem::path& target) {
    return create_named(folder, target, true, create_folder);
}

std::filesystem::path staged_name(const std::filesystem::path& folder, const std::filesystem::path& target,
                                  int attempt) {
    return folder / (staged_prefix(attempt) + target.filename().string());
}

bool give_name(const Staged& staged, const std::filesystem::path& name, const std::filesystem::path& target) {
    if (linkat(AT_FDCWD, staged.path.c_str(), AT_FDCWD, name.c_str(), AT_SYMLINK_FOLLOW) == 0) return true;
    if (errno != EEXIST) fail_to_write(target, errno);
    return false;
}

void flush_to_disk(const std::filesystem::path& path, const std::filesystem::path& target) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool flushed = file >= 0 && fsync(file) == 0;
    const int error = errno;
    if (file >= 0) close(file);
    if (!flushed) fail_to_write(target, error);
}

std::string with_final_names(std::string message) {
    for (auto at = message.find(staged_prefix()); at != std::string::npos;
         at = message.find(staged_prefix(), at))
        message.erase(at, message.find('-', at + staged_prefix().size()) + 1 - at);
    for (auto at = message.find(descriptors); at != std::string::npos; at = message.find(descriptors, at)) {
        const auto end = message.find_first_not_of("0123456789", at + std::strlen(descriptors));
        const auto known = targets().find(message.substr(at, end - at));
        if (known == targets().end())
            ++at;
        else
            message.replace(at, known->first.size(), known->second);
    }
    return message;
}

}  // namespace palpate::cli
