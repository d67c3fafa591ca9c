// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string>
#include <string_view>

namespace palpate::cli {

/// Tells on stderr how far long work is: a bar on a terminal, a plain line per step elsewhere. Not
/// thread-safe.
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
    bool quiet_ = false;
    bool terminal_ = false;
    bool open_ = false;
    std::string last_;
};

}  // namespace palpate::cli
