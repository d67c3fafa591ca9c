// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>

namespace palpate {

/// Counts what the calling thread allocates while it lives: operator new everywhere, malloc too where no
/// sanitizer has taken its place.
class AllocationTrap {
  public:
    AllocationTrap();
    ~AllocationTrap();
    std::size_t count() const;
};

}  // namespace palpate
