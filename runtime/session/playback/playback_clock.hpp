// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <string_view>

namespace palpate::session {

/// The time of a recording while it is looked at: goes on, slower or faster than it was, stands still, jumps.
class PlaybackClock {
  public:
    static constexpr double slowest = 1.0 / 8, fastest = 4;

    /// Begins at `begins` (s) and goes on at that speed until `ends`, where it stands still.
    PlaybackClock(double begins, double ends, double speed);

    /// Lets so many seconds of a person's time pass, 0 or more.
    void advance(double seconds);
    /// Jumps to that time (s), or the nearest there is.
    void seek(double time);
    /// Keys are X11 names in lower case: "space" stops and goes on, at the end from the beginning; "comma"
    /// and "period" halve and double the speed; "left" and "right" stop and step by what a tenth of a second
    /// shows; "home" and "end" jump there. Others do nothing.
    void press(std::string_view key);

    double time() const { return time_; }    ///< s, of the recording
    double speed() const { return speed_; }  ///< 1: as it was
    bool runs() const { return runs_; }
    double begins() const { return begins_; }
    double ends() const { return ends_; }
    /// Of the recording's time, 0 ... 1; 0 where there is but a moment.
    double share() const { return ends_ > begins_ ? (time_ - begins_) / (ends_ - begins_) : 0; }
    /// Jumps to a share of the recording's time.
    void seek_share(double share) { seek(begins_ + share * (ends_ - begins_)); }

  private:
    double begins_, ends_, time_, speed_;
    bool runs_ = true;
};

}  // namespace palpate::session
