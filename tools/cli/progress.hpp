// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <chrono>
#include <string>
#include <string_view>

namespace palpate::cli {

/// Tells on stderr how far long work is: a bar with the time left on a terminal, a plain line per step
/// elsewhere. Not thread-safe.
class Progress {
  public:
    Progress() = default;
    explicit Progress(bool quiet);
    Progress(const Progress&) = delete;
    Progress& operator=(const Progress&) = delete;
    Progress(Progress&&) = default;
    Progress& operator=(Progress&&) = default;
    ~Progress();

    /// Announces what happens now; `fraction` of the whole is done (0 ... 1).
    void step(std::string_view what, double fraction);
    /// Ends the bar; further steps start a new one.
    void finish();

  private:
    static std::string remaining(std::chrono::duration<double> elapsed, double fraction);

    std::chrono::steady_clock::time_point started_;  // when the bar appeared
    bool quiet_ = false;
    bool terminal_ = false;
    bool open_ = false;
    std::string last_;
};

}  // namespace palpate::cli
