// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/staged_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstdio>
#include <cstdlib>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <functional>
#include <sys/stat.h>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <tuple>
#include <unistd.h>
#include <utility>

#include "formats/model/errors.hpp"

namespace palpate::cli {
namespace {

// Paths the signal handler may unlink: fixed memory, published by the atomic flag.
struct Slot {
    std::array<char, PATH_MAX> path;
    std::atomic<bool> used{false};
};
std::array<Slot, 16> slots;

std::atomic<pid_t> child_to_interrupt{0};

std::atomic<bool> soft{false}, asked{false};

void remove_staged() {
    for (Slot& slot : slots)
        if (slot.used.load()) unlink(slot.path.data());
}

extern "C" void remove_and_exit(int) {
    if (soft.load() && !asked.exchange(true)) return;
    if (const pid_t child = child_to_interrupt.load(); child > 0) {
        kill(child, SIGTERM);
        waitpid(child, nullptr, 0);
    }
    remove_staged();
    constexpr char message[] = "\ninterrupted; nothing was left behind\n";
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, message, sizeof(message) - 1);
    _exit(130);
}

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

// Of the files that this machine's processes stage: ".part-1a2b3c4d-4711.0-liver.vtkhdf" is the first of
// process 4711.
std::string staged_prefix() {
    return ".part-" + machine() + "-";
}

std::string staged_prefix(int attempt) {
    return staged_prefix() + std::to_string(getpid()) + "." + std::to_string(attempt) + "-";
}

int claim_slot(const std::string& path) {
    for (std::size_t i = 0; i < slots.size(); ++i) {
        if (slots[i].used.load() || path.size() >= slots[i].path.size()) continue;
        std::memcpy(slots[i].path.data(), path.c_str(), path.size() + 1);
        slots[i].used.store(true);
        return static_cast<int>(i);
    }
    return -1;
}

[[noreturn]] void fail(const std::filesystem::path& target, const std::string& what, int error) {
    throw SystemFailure({.culprit = target.string(),
                         .found = what + ": " + std::generic_category().message(error),
                         .expected = "",
                         .next_step = "check free space and permissions of its folder"});
}

void flush_to_disk(const std::filesystem::path& path, const std::filesystem::path& target) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool flushed = file >= 0 && fsync(file) == 0;
    const int error = errno;
    if (file >= 0) close(file);
    if (!flushed) fail(target, "could not be written", error);
}

enum class Lock { ours, of_another, unknown };

// Who holds this lock on a staged file is still at work on it; the system lets go of it with the process,
// however that ends. It is on one byte that no file has, for a lock may keep a library's own descriptor from
// writing. Unknown on file systems without locks.
Lock lock(int file) {
    struct flock byte {};
    byte.l_type = F_WRLCK;
    byte.l_whence = SEEK_SET;
    byte.l_start = off_t{1} << 62;
    byte.l_len = 1;
    if (fcntl(file, F_OFD_SETLK, &byte) == 0) return Lock::ours;
    return errno == EAGAIN || errno == EACCES ? Lock::of_another : Lock::unknown;
}

bool is_still(int file, const std::filesystem::path& path) {
    struct stat opened {
    }, named{};
    return fstat(file, &opened) == 0 && lstat(path.c_str(), &named) == 0 && opened.st_ino == named.st_ino &&
           opened.st_dev == named.st_dev;
}

// Removes what killed processes of this machine left staged in a folder. Where it cannot be locked nobody can
// tell whether its process lives, and it stays.
void remove_orphans(const std::filesystem::path& folder) {
    std::error_code ignored;
    for (const auto& entry : std::filesystem::directory_iterator(folder, ignored)) {
        if (!entry.path().filename().string().starts_with(staged_prefix()) ||
            !entry.is_regular_file(ignored) || entry.is_symlink(ignored))
            continue;
        const int file = open(entry.path().c_str(), O_RDWR | O_CLOEXEC | O_NOFOLLOW);
        if (file < 0) continue;
        if (lock(file) == Lock::ours && is_still(file, entry.path())) unlink(entry.path().c_str());
        close(file);
    }
}

// Creates a file of its own beside the target and locks it; returns its descriptor and its path. Another
// process that looks for orphans may be quicker with the lock; then under another name.
std::pair<int, std::filesystem::path> create_staged(const std::filesystem::path& folder,
                                                    const std::filesystem::path& target) {
    constexpr int most_attempts = 100;
    for (int attempt = 0;; ++attempt) {
        const auto path = folder / (staged_prefix(attempt) + target.filename().string());
        const int file = open(path.c_str(), O_RDWR | O_CREAT | O_EXCL | O_CLOEXEC, 0666);
        if (file < 0 && (errno != EEXIST || attempt == most_attempts))
            fail(target, "could not be written", errno);
        if (file < 0) continue;
        if (lock(file) != Lock::of_another && is_still(file, path)) return {file, path};
        close(file);
    }
}

// A folder that nobody else looks into.
std::filesystem::path make_private_folder(const std::filesystem::path& target) {
    std::string name = std::filesystem::temp_directory_path() / "palpate-XXXXXX";
    if (mkdtemp(name.data()) == nullptr) fail(target, "has no folder to be made in", errno);
    return name;
}

std::filesystem::path folder_of(const std::filesystem::path& file) {
    return file.has_parent_path() ? file.parent_path() : ".";
}

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
bool require_file_or_pipe(const std::filesystem::path& target) {
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

// Hands a finished file to whoever reads a pipe.
void copy_into_pipe(const std::filesystem::path& staged, const std::filesystem::path& pipe) {
    std::signal(SIGPIPE, SIG_IGN);  // a reader that goes is an error like others
    std::ifstream from(staged, std::ios::binary);
    std::ofstream to(pipe, std::ios::binary);
    if (std::filesystem::file_size(staged) > 0) to << from.rdbuf();
    to.close();
    if (!to) fail(pipe, "could not be written", errno);
}

}  // namespace

StagedFile::StagedFile(const std::filesystem::path& target, bool replace)
    : is_pipe_(require_file_or_pipe(target)), target_(is_pipe_ ? target : followed(target)) {
    if (!replace && !is_pipe_ && std::filesystem::exists(target_))
        throw InvalidInput({target.string(), "exists already", "", "choose another name or pass --force"});
    const std::filesystem::path folder = is_pipe_ ? make_private_folder(target) : folder_of(target_);
    if (!std::filesystem::is_directory(folder))
        throw InvalidInput(
            {target.string(), "its folder does not exist", "", "make it first: mkdir -p " + folder.string()});
    if (!is_pipe_) remove_orphans(folder);
    std::tie(held_, temporary_) = create_staged(folder, target_);
    slot_ = claim_slot(temporary_.string());
}

StagedFile::~StagedFile() {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
    if (is_pipe_) std::filesystem::remove(temporary_.parent_path(), ignored);
    close(held_);
    if (slot_ >= 0) slots[slot_].used.store(false);
}

void StagedFile::write_text(const std::string& text) const {
    std::ofstream stream(temporary_, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream)
        throw SystemFailure(
            {target_.string(), "could not be written", "", "check free space and permissions of its folder"});
}

void StagedFile::commit() {
    if (is_pipe_) return copy_into_pipe(temporary_, target_);
    flush_to_disk(temporary_, target_);
    std::filesystem::rename(temporary_, target_);
    flush_to_disk(folder_of(target_), target_);
}

std::string with_final_names(std::string message) {
    for (auto at = message.find(staged_prefix()); at != std::string::npos;
         at = message.find(staged_prefix(), at))
        message.erase(at, message.find('-', at + staged_prefix().size()) + 1 - at);
    return message;
}

void remove_staged_files_on_interrupt() {
    struct sigaction action {};
    action.sa_handler = remove_and_exit;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
    // At a quota a write fails, and says so, instead of ending the process.
    std::signal(SIGXFSZ, SIG_IGN);
    // The terminal was closed; but nohup has the signal ignored, and that stays.
    struct sigaction hang_up {};
    sigaction(SIGHUP, nullptr, &hang_up);
    if (hang_up.sa_handler != SIG_IGN) sigaction(SIGHUP, &action, nullptr);
}

void end_softly_on_interrupt() {
    soft.store(true);
}

void end_within(int seconds) {
    std::thread([seconds] {
        std::this_thread::sleep_for(std::chrono::seconds(seconds));
        remove_staged();
        _exit(1);
    }).detach();
}

bool interrupt_asked() {
    return asked.load();
}

void pass_interrupts_to(pid_t child) {
    child_to_interrupt.store(child);
}

void write_text_file(const std::filesystem::path& target, const std::string& text, bool replace) {
    StagedFile staged(target, replace);
    staged.write_text(text);
    staged.commit();
}

}  // namespace palpate::cli
