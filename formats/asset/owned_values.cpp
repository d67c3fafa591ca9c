// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/owned_values.hpp"

#include <algorithm>
#include <cstdlib>
#include <new>
#include <sys/mman.h>

namespace palpate::asset {

std::shared_ptr<std::byte> huge_pages(std::size_t bytes) {
    constexpr std::size_t huge_page = std::size_t{2} << 20;
    const std::size_t whole = std::max<std::size_t>(1, (bytes + huge_page - 1) / huge_page) * huge_page;
    void* const pages = std::aligned_alloc(huge_page, whole);
    if (pages == nullptr) throw std::bad_alloc();
    madvise(pages, whole, MADV_HUGEPAGE);  // advice alone: without it the pages are small
    return {static_cast<std::byte*>(pages), std::free};
}

}  // namespace palpate::asset
