// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/case_builder/child_process.hpp"

#include <cerrno>
#include <chrono>
#include <csignal>
#include <fcntl.h>
#include <sys/prctl.h>
#include <sys/resource.h>
#include <sys/wait.h>
#include <system_error>
#include <unistd.h>

#include "formats/model/errors.hpp"
#include "tools/cli/outputs/staged_file.hpp"

namespace palpate::case_builder {
namespace {

// The child is killed where this process is, for it works under this one's locks.
pid_t spawn(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
    std::vector<char*> argv{const_cast<char*>(program.c_str())};
    for (const std::string& argument : arguments) argv.push_back(const_cast<char*>(argument.c_str()));
    argv.push_back(nullptr);
    const int nothing = open("/dev/null", O_WRONLY | O_CLOEXEC);
    int error = access(program.c_str(), X_OK) == 0 ? 0 : errno;
    const pid_t parent = getpid();
    const pid_t child = error == 0 ? fork() : -1;
    if (child == 0) {
        prctl(PR_SET_PDEATHSIG, SIGKILL);
        if (getppid() == parent && dup2(nothing, STDOUT_FILENO) >= 0) execv(program.c_str(), argv.data());
        _exit(127);
    }
    if (error == 0 && child < 0) error = errno;
    close(nothing);
    if (error != 0)
        throw SystemFailure({program.string(), "cannot be started: " + std::generic_category().message(error),
                             "", "build or install all of Palpate"});
    return child;
}

}  // namespace

ChildResult run_child(const std::filesystem::path& program, const std::vector<std::string>& arguments) {
    const auto start = std::chrono::steady_clock::now();
    const pid_t child = spawn(program, arguments);
    cli::pass_interrupts_to(child);
    int status = 0;
    rusage usage{};
    while (wait4(child, &status, 0, &usage) < 0 && errno == EINTR) {
    }
    cli::pass_interrupts_to(0);
    ChildResult result;
    result.exit_code = WIFEXITED(status) ? WEXITSTATUS(status) : 128 + WTERMSIG(status);
    result.seconds = std::chrono::duration<double>(std::chrono::steady_clock::now() - start).count();
    result.peak_memory_bytes = std::int64_t{usage.ru_maxrss} * 1024;  // Linux reports KiB
    return result;
}

}  // namespace palpate::case_builder
