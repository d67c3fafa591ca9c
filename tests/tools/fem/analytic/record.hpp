// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <iostream>
#include <string>
#include <vector>

namespace palpate::test {

/// Prints a row of measured figures, so that `ctest -V` shows how far a bound was from being broken.
inline void record(const std::string& what, const std::vector<double>& figures) {
    std::cout << what << ':';
    for (const double figure : figures) std::cout << ' ' << figure;
    std::cout << '\n';
}

}  // namespace palpate::test
