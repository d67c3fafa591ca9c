// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <chrono>
#include <cstddef>

namespace palpate::realtime {

/// Runs other threads' functions in the servo's thread, between two ticks, so that they see a state that
/// nothing changes meanwhile: what HDAPI calls synchronous and asynchronous callbacks. The servo's side is
/// wait-free; the others' waits by sleeping.
class ServoCallbacks {
  public:
    static constexpr std::size_t most = 16;  ///< functions at one time
    enum class Then { done, again };
    /// Must keep to what a tick may do: no allocation, lock or I/O.
    using Function = Then (*)(void* data) noexcept;
    using Handle = std::size_t;

    /// Asynchronous: returns at once; `function` runs once a tick until it answers done. `data` must live as
    /// long. Throws std::length_error if `most` are scheduled already.
    Handle schedule(Function function, void* data);
    /// Takes a function back and waits until it does not run any more: at most one tick. A handle is good
    /// until its function has answered done or this has been called. Not from the servo's thread.
    void unschedule(Handle handle);
    /// Synchronous: waits until `function` has answered done. False if it has not after `patience`, as where
    /// no servo runs; then it will not run any more. Not from the servo's thread.
    bool run(Function function, void* data,
             std::chrono::milliseconds patience = std::chrono::milliseconds(1000));

    /// The servo's side: runs every scheduled function once.
    void tick() noexcept;

  private:
    enum class State { free, claimed, scheduled, running, cancelled };
    struct Slot {
        std::atomic<State> state{State::free};
        std::atomic<std::size_t> ended{0};  // how many functions this slot has seen end
        Function function = nullptr;
        void* data = nullptr;
    };
    static void end(Slot& slot) noexcept;
    Slot* running_under(Handle handle) noexcept;

    std::array<Slot, most> slots_;  // a handle is ended * most + slot
};

}  // namespace palpate::realtime
