// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <cstdlib>
#include <filesystem>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>

namespace palpate::test {

/// The folder or file of a real data set; empty if it is absent. Throws std::runtime_error where nobody says
/// where to look: ctest does, and a test that it did not tell would be skipped everywhere.
inline std::filesystem::path real_data(const std::string& name) {
    const char* root = std::getenv("PALPATE_DATA");
    if (root == nullptr) throw std::runtime_error("PALPATE_DATA is not set: run the tests by ctest");
    const auto path = std::filesystem::path(root) / name;
    return std::filesystem::exists(path) ? path : std::filesystem::path();
}

}  // namespace palpate::test

/// Defines `variable` as the data set's path, or skips the test.
#define REQUIRE_REAL_DATA(variable, name)                                  \
    const std::filesystem::path variable = palpate::test::real_data(name); \
    if (variable.empty()) GTEST_SKIP() << "PALPATE_DATA: " << name << " is absent"
