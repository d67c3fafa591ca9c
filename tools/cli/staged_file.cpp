// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/staged_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <fstream>
#include <sys/wait.h>
#include <system_error>
#include <thread>
#include <unistd.h>

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

std::string temporary_prefix() {
    return ".part" + std::to_string(getpid()) + "-";
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

void flush_to_disk(const std::filesystem::path& path, const std::filesystem::path& target) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    const bool flushed = file >= 0 && fsync(file) == 0;
    const int error = errno;
    if (file >= 0) close(file);
    if (!flushed)
        throw SystemFailure({.culprit = target.string(),
                             .found = "could not be written: " + std::generic_category().message(error),
                             .expected = "",
                             .next_step = "check free space and permissions of its folder"});
}

}  // namespace

StagedFile::StagedFile(std::filesystem::path target, bool replace) : target_(std::move(target)) {
    const std::filesystem::path folder = target_.has_parent_path() ? target_.parent_path() : ".";
    if (std::filesystem::is_directory(target_))
        throw InvalidInput({target_.string(), "is a folder", "a file name", "name the file to write"});
    if (!replace && std::filesystem::exists(target_))
        throw InvalidInput({target_.string(), "exists already", "", "choose another name or pass --force"});
    if (!std::filesystem::is_directory(folder))
        throw InvalidInput({target_.string(), "its folder does not exist", "",
                            "make it first: mkdir -p " + folder.string()});
    temporary_ = folder / (temporary_prefix() + target_.filename().string());
    slot_ = claim_slot(temporary_.string());
}

StagedFile::~StagedFile() {
    std::error_code ignored;
    std::filesystem::remove(temporary_, ignored);
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
    flush_to_disk(temporary_, target_);
    std::filesystem::rename(temporary_, target_);
    flush_to_disk(target_.has_parent_path() ? target_.parent_path() : ".", target_);
}

std::string with_final_names(std::string message) {
    const std::string prefix = temporary_prefix();
    for (auto at = message.find(prefix); at != std::string::npos; at = message.find(prefix, at))
        message.erase(at, prefix.size());
    return message;
}

void remove_staged_files_on_interrupt() {
    struct sigaction action {};
    action.sa_handler = remove_and_exit;
    sigaction(SIGINT, &action, nullptr);
    sigaction(SIGTERM, &action, nullptr);
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
