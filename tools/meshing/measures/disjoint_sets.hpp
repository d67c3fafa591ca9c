// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstddef>
#include <numeric>
#include <vector>

namespace palpate {

/// Union-find; the smallest member of a set is its root, so numbering by root is deterministic.
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    }

    std::size_t root(std::size_t member) {
        while (parent_[member] != member) member = parent_[member] = parent_[parent_[member]];
        return member;
    }

    void join(std::size_t a, std::size_t b) {
        a = root(a);
        b = root(b);
        if (a != b) parent_[a < b ? b : a] = a < b ? a : b;
    }

  private:
    std::vector<std::size_t> parent_;
};

}  // namespace palpate
