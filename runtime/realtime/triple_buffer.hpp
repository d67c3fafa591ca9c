// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <atomic>
#include <cstdint>
#include <type_traits>

namespace palpate::realtime {

/// Hands the latest value from one writing thread to one reading thread; both sides are wait-free and never
/// allocate. Small trivially copyable values go through write() and read(); larger ones (preallocated
/// vectors) are filled in place through back() and publish(), and looked at through refresh() and front().
template <typename T>
class TripleBuffer {
  public:
    /// Copies `initial` into all three slots, so that in-place payloads are allocated once, here.
    explicit TripleBuffer(const T& initial = T{}) : slots_{Slot{initial}, Slot{initial}, Slot{initial}} {}
    TripleBuffer(const TripleBuffer&) = delete;
    TripleBuffer& operator=(const TripleBuffer&) = delete;

    /// Writer: publishes a copy of `value`.
    void write(const T& value) noexcept {
        static_assert(std::is_trivially_copyable_v<T>, "fill larger payloads in place: back(), publish()");
        back() = value;
        publish();
    }
    /// Writer: the slot to fill next; its content is an older value.
    T& back() noexcept { return slots_[back_].value; }
    /// Writer: makes back() the latest value.
    void publish() noexcept { back_ = middle_.exchange(back_ | fresh, std::memory_order_acq_rel) & index; }

    /// Reader: moves to the latest value; tells whether it is newer than the one seen before.
    bool refresh() noexcept {
        if (!(middle_.load(std::memory_order_relaxed) & fresh)) return false;
        front_ = middle_.exchange(front_, std::memory_order_acq_rel) & index;
        return true;
    }
    /// Reader: the value as of the last refresh(), steady until the next one.
    const T& front() const noexcept { return slots_[front_].value; }
    /// Reader: refreshes and looks.
    const T& read() noexcept {
        refresh();
        return front();
    }

  private:
    static constexpr std::uint8_t index = 3;
    static constexpr std::uint8_t fresh = 4;
    struct alignas(64) Slot {
        T value;
    };
    std::array<Slot, 3> slots_;
    alignas(64) std::atomic<std::uint8_t> middle_{1};
    alignas(64) std::uint8_t back_ = 0;   // the writer's
    alignas(64) std::uint8_t front_ = 2;  // the reader's
};

}  // namespace palpate::realtime
