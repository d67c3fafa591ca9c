// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstring>
#include <memory>

namespace palpate::asset {

/// Room for `bytes` bytes, in huge pages where the system gives them: a large array then costs a page fault
/// for each 2 MB and not for each 4 kB. Never null; throws std::bad_alloc.
std::shared_ptr<std::byte> huge_pages(std::size_t bytes);

/// A copy of `count` values that belongs to the process, whatever becomes of the file that they came from.
template <typename T>
std::shared_ptr<const T> owned(const T* values, std::size_t count) {
    const auto pages = huge_pages(count * sizeof(T));
    std::memcpy(pages.get(), values, count * sizeof(T));
    return {pages, reinterpret_cast<const T*>(pages.get())};
}

}  // namespace palpate::asset
