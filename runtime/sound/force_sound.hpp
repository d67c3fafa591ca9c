// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <memory>

namespace palpate::sound {

/// Lets a force be heard, as tone_of() says, on the desktop's own output. Silent, and without a sound device,
/// until it is turned on. Not thread-safe.
class ForceSound {
  public:
    ForceSound();
    ~ForceSound();
    ForceSound(const ForceSound&) = delete;
    ForceSound& operator=(const ForceSound&) = delete;

    /// On, or off again. Throws SystemFailure if nothing plays sound here.
    void turn();
    bool on() const { return player_ != nullptr; }
    /// The force now, N; as often as the window is drawn. Nothing while it is off.
    void follow(double newtons);

  private:
    class Player;
    std::unique_ptr<Player> player_;
};

}  // namespace palpate::sound
