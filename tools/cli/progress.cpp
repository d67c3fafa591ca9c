// SPDX-License-Identifier: Apache-2.0
#include "tools/cli/progress.hpp"

#include <algorithm>
#include <cstdio>
#include <fmt/format.h>
#include <spdlog/spdlog.h>
#include <unistd.h>

namespace palpate::cli {

Progress::Progress(bool quiet) : quiet_(quiet), terminal_(isatty(STDERR_FILENO) == 1) {}

Progress::~Progress() {
    finish();
}

void Progress::step(std::string_view what, double fraction) {
    if (quiet_) return;
    if (!terminal_) {
        if (what != last_) spdlog::info("{}", what);
        last_ = what;
        return;
    }
    const auto now = std::chrono::steady_clock::now();
    if (!open_) started_ = now;
    constexpr int width = 30;
    const int filled = static_cast<int>(std::clamp(fraction, 0.0, 1.0) * width);
    const std::string bar = std::string(static_cast<std::size_t>(filled), '#') +
                            std::string(static_cast<std::size_t>(width - filled), ' ');
    std::fprintf(stderr, "\r\033[K[%s] %3.0f %%  %.*s%s", bar.c_str(), 100.0 * fraction,
                 static_cast<int>(what.size()), what.data(), remaining(now - started_, fraction).c_str());
    std::fflush(stderr);
    open_ = true;
}

// As if the rest went as fast as what is done; nothing while that tells too little.
std::string Progress::remaining(std::chrono::duration<double> elapsed, double fraction) {
    if (fraction < 0.05 || elapsed.count() < 3) return "";
    const double seconds = elapsed.count() * (1 - fraction) / fraction;
    return seconds < 90 ? fmt::format(", {:.0f} s left", seconds)
                        : fmt::format(", {:.0f} min left", seconds / 60);
}

void Progress::finish() {
    if (open_) std::fprintf(stderr, "\r\033[K");
    open_ = false;
    last_.clear();
}

}  // namespace palpate::cli
