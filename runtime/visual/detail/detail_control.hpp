// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstdint>
#include <vector>

namespace palpate::visual {

/// Chooses how much is drawn so that 30 frames a second are kept. Half the frames of a while decide, so that
/// a single slow one changes nothing. Where they near the limit it goes down a level, or two where they are
/// far over it; where there is ample room for long it tries one more. A try that failed is not made again
/// soon: the wait doubles each time, up to two minutes, so that the picture does not go to and fro.
class DetailControl {
  public:
    /// Begins with everything: level `levels`, of 1 or more.
    explicit DetailControl(int levels);

    /// A frame has come `seconds` after the one before; tells whether the level has changed.
    bool take(double seconds);

    int levels() const { return levels_; }
    int level() const { return level_; }  ///< `levels()`: everything; 1: the least
    std::int64_t changes() const { return changes_; }

  private:
    bool change(int level);

    int levels_, level_;
    std::int64_t changes_ = 0;
    int to_skip_;                 // frames, in which a new level's shaders are made
    std::vector<double> frames_;  // s, since the last decision
    double gathered_ = 0;         // s, of frames_
    double roomy_ = 0;            // s, for which there has been room for more
    double lasted_ = 0;           // s, of this level
    bool trying_ = false;         // this level, after one of less
    double wait_;                 // s of room before the next try
};

}  // namespace palpate::visual
