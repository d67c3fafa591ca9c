// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <array>
#include <cstddef>

#include "tests/runtime/devices/openhaptics/hd_library/hd_types.hpp"

namespace palpate::hd {

/// The errors nobody has asked for yet, the latest on top; the oldest make room. Never allocates.
class ErrorStack {
  public:
    void push(unsigned code, Handle device) noexcept;
    /// Takes the latest away; success if there is none.
    ErrorInfo pop() noexcept;
    void clear() noexcept { count_ = 0; }

  private:
    std::array<ErrorInfo, 64> errors_{};
    std::size_t next_ = 0, count_ = 0;
};

/// What an error's code means, for people.
const char* error_text(unsigned code) noexcept;

}  // namespace palpate::hd
