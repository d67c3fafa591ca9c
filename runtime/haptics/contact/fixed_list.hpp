// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <array>
#include <cassert>
#include <cstddef>

namespace palpate::haptics {

/// A list in place, of `capacity` elements at most: what a tick may grow, since it must not allocate.
template <typename T, std::size_t capacity>
class FixedList {
  public:
    std::size_t size() const noexcept { return size_; }
    bool empty() const noexcept { return size_ == 0; }
    bool full() const noexcept { return size_ == capacity; }
    void clear() noexcept { size_ = 0; }
    /// Only if it is not full (asserted).
    void push_back(const T& value) noexcept {
        assert(!full());
        values_[size_++] = value;
    }
    /// The same, of an element that holds what was there before, to be filled in place.
    T& push_back() noexcept {
        assert(!full());
        return values_[size_++];
    }
    /// Leaves the first `size` elements, of at least as many (asserted).
    void cut(std::size_t size) noexcept {
        assert(size <= size_);
        size_ = size;
    }
    /// Takes out the elements of which `takes` says so, in place.
    template <typename Takes>
    void erase_if(const Takes& takes) noexcept {
        size_ = static_cast<std::size_t>(std::remove_if(begin(), end(), takes) - begin());
    }

    T& operator[](std::size_t i) noexcept { return values_[i]; }
    const T& operator[](std::size_t i) const noexcept { return values_[i]; }
    T* begin() noexcept { return values_.data(); }
    T* end() noexcept { return values_.data() + size_; }
    const T* begin() const noexcept { return values_.data(); }
    const T* end() const noexcept { return values_.data() + size_; }
    T* data() noexcept { return values_.data(); }
    const T* data() const noexcept { return values_.data(); }

  private:
    std::array<T, capacity> values_{};
    std::size_t size_ = 0;
};

}  // namespace palpate::haptics
