// SPDX-License-Identifier: Apache-2.0
#include "runtime/realtime/file_watch.hpp"

#include <array>
#include <sys/stat.h>

#include "runtime/realtime/periodic_clock.hpp"

namespace palpate::realtime {
namespace {

// What a file is known by; all zero where there is none.
std::array<std::int64_t, 5> identity_of(const std::filesystem::path& path) {
    struct stat status {};
    if (stat(path.c_str(), &status) != 0) return {};
    return {static_cast<std::int64_t>(status.st_dev), static_cast<std::int64_t>(status.st_ino),
            std::int64_t{status.st_size}, std::int64_t{status.st_mtim.tv_sec},
            std::int64_t{status.st_mtim.tv_nsec}};
}

}  // namespace

FileWatch::FileWatch(std::filesystem::path path, OnChange on_change)
    : path_(std::move(path)), on_change_(std::move(on_change)) {
    thread_ = std::thread([this, expected = identity_of(path_)] {
        PeriodicClock clock(period_ns);
        bool gone = false;
        while (!stop_requested_.load(std::memory_order_relaxed)) {
            clock.wait();
            if ((identity_of(path_) != expected) == gone) continue;
            gone = !gone;
            on_change_(gone);
        }
    });
}

FileWatch::~FileWatch() {
    stop_requested_.store(true);
    thread_.join();
}

}  // namespace palpate::realtime
