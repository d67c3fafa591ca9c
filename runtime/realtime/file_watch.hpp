// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <thread>

namespace palpate::realtime {

/// Watches from a thread of its own whether a file is still the one it was: the same inode, size and time of
/// change under the same path.
class FileWatch {
  public:
    static constexpr std::int64_t period_ns = 5'000'000;
    /// Must not throw.
    using OnChange = std::function<void(bool gone)>;

    /// Looks at the file now, then every 5 ms; calls `on_change`, from its thread, with true when the file is
    /// no longer what it was, and with false when it is again. What `on_change` refers to must outlive the
    /// watch.
    FileWatch(std::filesystem::path path, OnChange on_change);
    FileWatch(const FileWatch&) = delete;
    FileWatch& operator=(const FileWatch&) = delete;
    ~FileWatch();

  private:
    std::filesystem::path path_;
    OnChange on_change_;
    std::atomic<bool> stop_requested_{false};
    std::thread thread_;
};

}  // namespace palpate::realtime
