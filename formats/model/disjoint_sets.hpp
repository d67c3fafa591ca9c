// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <numeric>
#include <vector>

namespace palpate {

/// Union-find over 0 ... count - 1 (Galler and Fischer 1964, with path halving); the smallest member of a set
/// is its root, so numbering by root is deterministic.
class DisjointSets {
  public:
    explicit DisjointSets(std::size_t count) : parent_(count) {
        std::iota(parent_.begin(), parent_.end(), std::size_t{0});
    }

    /// The smallest member of `member`'s set.
    std::size_t root(std::size_t member) {
        while (parent_[member] != member) member = parent_[member] = parent_[parent_[member]];
        return member;
    }

    void join(std::size_t a, std::size_t b) {
        a = root(a);
        b = root(b);
        if (a != b) parent_[a < b ? b : a] = a < b ? a : b;
    }

    /// A number for each member's set, counted from 0 in the order of their smallest members.
    std::vector<std::size_t> numbered() {
        std::vector<std::size_t> number(parent_.size());
        std::size_t count = 0;
        for (std::size_t i = 0; i < parent_.size(); ++i) number[i] = root(i) == i ? count++ : number[root(i)];
        return number;
    }

  private:
    std::vector<std::size_t> parent_;
};

}  // namespace palpate
