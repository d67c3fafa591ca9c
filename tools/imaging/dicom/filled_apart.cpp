// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/imaging/dicom/filled_apart.hpp"

#include <cerrno>
#include <csignal>
#include <cstring>
#include <fcntl.h>
#include <memory>
#include <sys/mman.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/model/errors.hpp"

namespace palpate::imaging {
namespace {

[[noreturn]] void refuse(const char* what) {
    throw SystemFailure(
        {"compressed DICOM pixels", std::string(what) + ": " + std::strerror(errno), "", "try again"});
}

// In the child: its end is its own, without a word, a core or a handler of the parent's.
void stand_apart(rlim_t seconds) {
    for (const int signal : {SIGABRT, SIGSEGV, SIGBUS, SIGFPE, SIGILL}) std::signal(signal, SIG_DFL);
    prctl(PR_SET_PDEATHSIG, SIGKILL);
    const rlimit no_core{0, 0}, time{seconds, seconds};
    setrlimit(RLIMIT_CORE, &no_core);
    setrlimit(RLIMIT_CPU, &time);
    if (const int nowhere = open("/dev/null", O_WRONLY | O_CLOEXEC); nowhere >= 0)
        dup2(nowhere, STDERR_FILENO);
}

bool ended_well(pid_t child) {
    int status = 0;
    while (waitpid(child, &status, 0) < 0)
        if (errno != EINTR) return false;
    return WIFEXITED(status) && WEXITSTATUS(status) == 0;
}

}  // namespace

std::optional<std::vector<char>> filled_apart(std::size_t size,
                                              const std::function<bool(std::span<char>)>& fill) {
    void* const mapped = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED | MAP_ANONYMOUS, -1, 0);
    if (mapped == MAP_FAILED) refuse("memory cannot be had");
    const auto unmap = [size](char* bytes) { munmap(bytes, size); };
    const std::unique_ptr<char, decltype(unmap)> shared(static_cast<char*>(mapped), unmap);
    const std::span<char> bytes(shared.get(), size);
    const pid_t child = fork();
    if (child < 0) refuse("no process can be had");
    if (child == 0) {
        stand_apart(60 + size / (1U << 20));
        bool filled = false;
        try {
            filled = fill(bytes);
        } catch (...) {  // as false
        }
        _exit(filled ? 0 : 1);
    }
    if (!ended_well(child)) return {};
    return std::vector<char>(bytes.begin(), bytes.end());
}

}  // namespace palpate::imaging
