// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/report/pictures/virtual_display.hpp"

#include <X11/Xlib.h>
#include <array>
#include <cctype>
#include <csignal>
#include <cstdlib>
#include <fcntl.h>
#include <poll.h>
#include <sys/prctl.h>
#include <sys/wait.h>
#include <unistd.h>

#include "formats/model/errors.hpp"

namespace palpate::report {
namespace {

[[noreturn]] void become_server(int display_fd, pid_t parent) {
    prctl(PR_SET_PDEATHSIG, SIGTERM);
    if (getppid() != parent) _exit(1);  // the parent died before the line above
    const int null = open("/dev/null", O_RDWR);
    dup2(null, STDIN_FILENO);
    dup2(null, STDOUT_FILENO);
    dup2(null, STDERR_FILENO);
    const std::string fd = std::to_string(display_fd);
    execlp("Xvfb", "Xvfb", "-displayfd", fd.c_str(), "-screen", "0", "1280x1024x24", "-nolisten", "tcp",
           "-noreset", static_cast<char*>(nullptr));
    _exit(127);
}

// The server writes its display number and a newline once it accepts clients; nothing if it gave up.
std::string display_number(int fd) {
    constexpr int patience_ms = 30'000;
    std::string number;
    char c = 0;
    for (pollfd waiting{fd, POLLIN, 0}; poll(&waiting, 1, patience_ms) == 1 && read(fd, &c, 1) == 1;) {
        if (c == '\n') return number;
        number += c;
    }
    return {};
}

}  // namespace

VirtualDisplay::VirtualDisplay() {
    if (const char* display = std::getenv("DISPLAY"); display != nullptr) former_ = display;
    if (!former_.empty()) connection_ = XOpenDisplay(nullptr);
    if (connection_ != nullptr) return;
    std::array<int, 2> channel{};
    const pid_t parent = getpid();
    if (pipe(channel.data()) != 0) throw SystemFailure({"Xvfb", "no pipe to start it with", "", ""});
    server_ = fork();
    if (server_ == 0) {
        close(channel[0]);
        become_server(channel[1], parent);
    }
    close(channel[1]);
    const std::string number = server_ > 0 ? display_number(channel[0]) : "";
    close(channel[0]);
    if (number.empty()) {
        int status = 0;
        if (server_ > 0) {
            kill(server_, SIGTERM);
            waitpid(server_, &status, 0);
        }
        const bool missing = WIFEXITED(status) && WEXITSTATUS(status) == 127;
        throw SystemFailure({.culprit = "Xvfb",
                             .found = missing ? "not installed, and pictures need an X display"
                                              : "started, but gave no display for pictures",
                             .expected = "",
                             .next_step = missing ? "install the package 'xvfb' or set DISPLAY"
                                                  : "run 'Xvfb :99' by hand to see why, or set DISPLAY"});
    }
    // NOLINTNEXTLINE(concurrency-mt-unsafe): where VTK looks; made before it starts a thread
    setenv("DISPLAY", (":" + number).c_str(), 1);
}

VirtualDisplay::~VirtualDisplay() {
    if (connection_ != nullptr) XCloseDisplay(static_cast<Display*>(connection_));
    if (server_ <= 0) return;
    kill(server_, SIGTERM);
    waitpid(server_, nullptr, 0);
    // NOLINTBEGIN(concurrency-mt-unsafe): VTK's threads have ended
    if (former_.empty())
        unsetenv("DISPLAY");
    else
        setenv("DISPLAY", former_.c_str(), 1);
    // NOLINTEND(concurrency-mt-unsafe)
}

}  // namespace palpate::report
