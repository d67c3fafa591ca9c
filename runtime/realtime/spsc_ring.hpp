// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <atomic>
#include <bit>
#include <concepts>
#include <cstddef>
#include <cstdint>
#include <type_traits>
#include <vector>

namespace palpate::realtime {

/// A queue from one pushing to one popping thread; both sides are wait-free, memory is allocated once.
template <typename T>
class SpscRing {
    static_assert(std::is_trivially_copyable_v<T>);

  public:
    /// Holds at least `capacity` values (rounded up to a power of two).
    explicit SpscRing(std::size_t capacity) : slots_(std::bit_ceil(capacity)), mask_(slots_.size() - 1) {}

    std::size_t capacity() const noexcept { return slots_.size(); }

    /// Producer: appends; when full, drops the value, counts it and returns false.
    bool push(const T& value) noexcept {
        return fill([&](T& slot) { slot = value; });
    }

    /// Producer: appends what `write` makes of the next slot, which holds an older value, so that a part of a
    /// large value can be copied alone; when full, as push(), and `write` is not called.
    template <std::invocable<T&> Write>
    bool fill(const Write& write) noexcept {
        const std::size_t head = head_.load(std::memory_order_relaxed);
        if (head - known_tail_ == slots_.size()) {
            known_tail_ = tail_.load(std::memory_order_acquire);
            if (head - known_tail_ == slots_.size()) {
                dropped_.fetch_add(1, std::memory_order_relaxed);
                return false;
            }
        }
        write(slots_[head & mask_]);
        head_.store(head + 1, std::memory_order_release);
        return true;
    }

    /// Consumer: takes the oldest value; false if there is none.
    bool pop(T& value) noexcept {
        const std::size_t tail = tail_.load(std::memory_order_relaxed);
        if (tail == known_head_) {
            known_head_ = head_.load(std::memory_order_acquire);
            if (tail == known_head_) return false;
        }
        value = slots_[tail & mask_];
        tail_.store(tail + 1, std::memory_order_release);
        return true;
    }

    /// Any thread: values dropped so far.
    std::uint64_t dropped() const noexcept { return dropped_.load(std::memory_order_relaxed); }

  private:
    std::vector<T> slots_;
    std::size_t mask_;
    alignas(64) std::atomic<std::size_t> head_{0};  // next slot to fill
    std::size_t known_tail_ = 0;                    // the producer's last look at tail_
    std::atomic<std::uint64_t> dropped_{0};
    alignas(64) std::atomic<std::size_t> tail_{0};  // next slot to take
    std::size_t known_head_ = 0;                    // the consumer's last look at head_
};

}  // namespace palpate::realtime
