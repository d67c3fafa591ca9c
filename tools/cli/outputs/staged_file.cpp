// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/outputs/staged_file.hpp"

#include <array>
#include <atomic>
#include <cerrno>
#include <chrono>
#include <climits>
#include <csignal>
#include <cstring>
#include <fstream>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "formats/model/errors.hpp"

namespace palpate::cli {
namespace {

// Paths the signal handler may remove: fixed memory, published by the atomic flag.
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
    constexpr char message[] = "\ninterrupted; nothing half written was left behind\n";
    [[maybe_unused]] const ssize_t written = write(STDERR_FILENO, message, sizeof(message) - 1);
    _exit(130);
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

void release_slot(int slot) {
    if (slot >= 0) slots[static_cast<std::size_t>(slot)].used.store(false);
}

[[noreturn]] void refuse_to_replace(const std::filesystem::path& target) {
    throw InvalidInput({target.string(), "exists already", "", "choose another name or pass --force"});
}

// Hands a finished file to whoever reads a pipe.
void copy_into_pipe(const std::filesystem::path& staged, const std::filesystem::path& pipe) {
    std::signal(SIGPIPE, SIG_IGN);  // a reader that goes is an error like others
    std::ifstream from(staged, std::ios::binary);
    std::ofstream to(pipe, std::ios::binary);
    if (std::filesystem::file_size(staged) > 0) to << from.rdbuf();
    to.close();
    if (!to) fail_to_write(pipe, errno);
}

}  // namespace

StagedFile::StagedFile(const std::filesystem::path& target, bool replace)
    : target_(output_target(target)), replace_(replace) {
    if (!replace && !target_.is_pipe && std::filesystem::exists(target_.path)) refuse_to_replace(target);
    take_stdout_for(target_.path);
    const std::filesystem::path folder =
        target_.is_pipe ? std::filesystem::temp_directory_path() : folder_of(target_.path);
    if (!std::filesystem::is_directory(folder))
        throw InvalidInput(
            {target.string(), "its folder does not exist", "", "make it first: mkdir -p " + folder.string()});
    remove_orphans(folder);
    staged_ = create_staged(folder, target_.path, target_.is_pipe);
    if (staged_.has_name) slot_ = claim_slot(staged_.path.string());
}

StagedFile::~StagedFile() {
    std::error_code ignored;
    if (staged_.has_name) std::filesystem::remove(staged_.path, ignored);
    close(staged_.descriptor);
    release_slot(slot_);
}

void StagedFile::write_text(const std::string& text) const {
    std::ofstream stream(staged_.path, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream) fail_to_write(target_.path, errno != 0 ? errno : EIO);
}

void StagedFile::commit() {
    if (target_.is_pipe) return copy_into_pipe(staged_.path, target_.path);
    flush_to_disk(staged_.path, target_.path);
    const std::filesystem::path folder = folder_of(target_.path);
    // What must not replace a file gets the target's name at once, what may a hidden one first.
    if (!replace_ && !staged_.has_name) {
        if (!give_name(staged_, target_.path, target_.path)) refuse_to_replace(target_.path);
        return flush_to_disk(folder, target_.path);
    }
    if (!staged_.has_name) take_hidden_name(folder);
    if (!replace_ && std::filesystem::exists(target_.path)) refuse_to_replace(target_.path);
    if (rename(staged_.path.c_str(), target_.path.c_str()) != 0) fail_to_write(target_.path, errno);
    flush_to_disk(folder, target_.path);
}

void StagedFile::take_hidden_name(const std::filesystem::path& folder) {
    for (int attempt = 0;; ++attempt) {
        const std::filesystem::path name = staged_name(folder, target_.path, attempt);
        slot_ = claim_slot(name.string());
        if (give_name(staged_, name, target_.path)) {
            staged_ = {staged_.descriptor, name};
            return;
        }
        release_slot(slot_);
        if (attempt == most_attempts) fail_to_write(target_.path, EEXIST);
    }
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
