// SPDX-License-Identifier: GPL-3.0-or-later
#include <algorithm>
#include <cstdlib>
#include <gtest/gtest.h>
#include <stdexcept>
#include <string>

#include "tools/imaging/dicom/filled_apart.hpp"

namespace palpate {
namespace {

using imaging::filled_apart;

TEST(FilledApart, gives_what_was_written) {
    const auto bytes = filled_apart(3, [](std::span<char> all) {
        std::ranges::copy(std::string("abc"), all.begin());
        return true;
    });
    ASSERT_TRUE(bytes);
    EXPECT_EQ(std::string(bytes->begin(), bytes->end()), "abc");
}

TEST(FilledApart, gives_nothing_where_the_other_process_does_not_end_well) {
    EXPECT_FALSE(filled_apart(3, [](std::span<char>) { return false; }));
    EXPECT_FALSE(filled_apart(3, [](std::span<char>) -> bool { throw std::runtime_error("no"); }));
    EXPECT_FALSE(filled_apart(3, [](std::span<char>) -> bool { std::abort(); }));
    EXPECT_FALSE(filled_apart(3, [](std::span<char>) -> bool { std::exit(3); }));
}

}  // namespace
}  // namespace palpate
