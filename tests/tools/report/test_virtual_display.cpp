// SPDX-License-Identifier: GPL-3.0-or-later
#include <cerrno>
#include <chrono>
#include <csignal>
#include <cstdlib>
#include <gtest/gtest.h>
#include <sys/wait.h>
#include <thread>
#include <unistd.h>

#include "formats/model/errors.hpp"
#include "tools/report/pictures/virtual_display.hpp"

namespace palpate {
namespace {

using namespace report;

class VirtualDisplayTest : public testing::Test {
  protected:
    void SetUp() override {
        if (access("/usr/bin/Xvfb", X_OK) != 0) GTEST_SKIP() << "xvfb is not installed";
        unsetenv("DISPLAY");
    }
};

bool ends_soon(pid_t pid) {
    for (int tenth = 0; tenth < 100; ++tenth) {
        if (kill(pid, 0) != 0 && errno == ESRCH) return true;
        std::this_thread::sleep_for(std::chrono::milliseconds(100));
    }
    return false;
}

TEST_F(VirtualDisplayTest, a_headless_machine_gets_a_display_for_as_long_as_it_is_needed) {
    pid_t server = 0;
    {
        const VirtualDisplay display;
        ASSERT_NE(std::getenv("DISPLAY"), nullptr);
        server = display.server();
        ASSERT_GT(server, 0);
        EXPECT_EQ(kill(server, 0), 0);
        const std::string first = std::getenv("DISPLAY");
        const VirtualDisplay second;  // one answers already
        EXPECT_EQ(second.server(), -1);
        EXPECT_EQ(first, std::getenv("DISPLAY"));
    }
    EXPECT_EQ(std::getenv("DISPLAY"), nullptr);
    EXPECT_TRUE(ends_soon(server));
}

TEST_F(VirtualDisplayTest, the_server_ends_with_a_process_that_is_killed) {
    int channel[2];
    ASSERT_EQ(pipe(channel), 0);
    const pid_t child = fork();
    if (child == 0) {
        const VirtualDisplay display;
        const pid_t server = display.server();
        if (write(channel[1], &server, sizeof server) != sizeof server) _exit(1);
        pause();
    }
    pid_t server = 0;
    ASSERT_EQ(read(channel[0], &server, sizeof server), static_cast<ssize_t>(sizeof server));
    kill(child, SIGKILL);
    waitpid(child, nullptr, 0);
    ASSERT_GT(server, 0);
    EXPECT_TRUE(ends_soon(server));
}

TEST_F(VirtualDisplayTest, without_xvfb_the_package_is_named) {
    const std::string path = std::getenv("PATH");
    setenv("PATH", "/nonexistent", 1);
    try {
        const VirtualDisplay display;
        ADD_FAILURE() << "a display came from nowhere";
    } catch (const SystemFailure& error) {
        EXPECT_NE(std::string(error.what()).find("'xvfb'"), std::string::npos) << error.what();
    }
    setenv("PATH", path.c_str(), 1);
}

}  // namespace
}  // namespace palpate
