// SPDX-License-Identifier: Apache-2.0
#include <gtest/gtest.h>
#include <string>

#include "formats/model/reading/utf8.hpp"

namespace palpate {
namespace {

// Unicode 15, table 3-7, at the ends of its ranges.
TEST(Utf8, is_what_unicode_calls_well_formed) {
    for (const char* const good :
         {"", "liver", "\x7f", "\xc2\x80", "\xdf\xbf", "\xe0\xa0\x80", "\xed\x9f\xbf", "\xee\x80\x80",
          "\xef\xbf\xbf", "\xf0\x90\x80\x80", "\xf4\x8f\xbf\xbf"})
        EXPECT_TRUE(is_utf8(good)) << good;
    for (const char* const bad : {"\x80", "\xbf", "\xc0\x80", "\xc1\xbf", "\xc2", "\xc2\x41", "\xe0\x9f\xbf",
                                  "\xe2\x80", "\xed\xa0\x80", "\xed\xbf\xbf", "\xf0\x8f\xbf\xbf",
                                  "\xf4\x90\x80\x80", "\xf5\x80\x80\x80", "\xff", "a\xc3"})
        EXPECT_FALSE(is_utf8(bad)) << bad;
    EXPECT_TRUE(is_utf8(std::string(1, '\0')));
}

TEST(Utf8, is_printable_without_controls_and_what_is_not_seen_or_turns_the_writing) {
    for (const char* const good : {"", "Leber 2", "Läsion", "肝臓", "می\u200cشود", "\xe2\x80\x93"})
        EXPECT_TRUE(is_printable(good)) << good;
    for (const char* const bad :
         {"a\n", "\x1b[2J", "\x7f", "\xc2\x85", "\xe2\x80\xae", "\xe2\x81\xa6", "\xff", "a\u00ad", "\u061cb",
          "\u200b", "\u2028", "\ufeffliver", "l\U000e0041"})
        EXPECT_FALSE(is_printable(bad)) << bad;
}

}  // namespace
}  // namespace palpate
