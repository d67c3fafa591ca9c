// SPDX-License-Identifier: Apache-2.0
#include <cstdlib>
#include <filesystem>
#include <fstream>
#include <gtest/gtest.h>
#include <libintl.h>

#include "runtime/texts/translated.hpp"

namespace palpate {
namespace {

using texts::looked_up;
using texts::translated;

class Translated : public testing::Test {
  protected:
    static void speak(const char* language) {
        setenv("LC_ALL", "C.UTF-8", 1);
        setenv("LANGUAGE", language, 1);
        texts::follow_the_desktop();
    }
};

TEST_F(Translated, texts_follow_the_desktops_language_and_numbers_do_not) {
    speak("de");
    EXPECT_EQ(looked_up("paused"), "angehalten");
    EXPECT_EQ(translated("too hard: {:.2f} N, at most {:.2f} N", 1.5, 0.25),
              "zu fest: 1.50 N, höchstens 0.25 N");
}

TEST_F(Translated, what_no_catalogue_has_stays_english) {
    speak("de");
    EXPECT_EQ(looked_up("Lobus caudatus"), "Lobus caudatus");
    EXPECT_EQ(looked_up(""), "");
    speak("tlh");
    EXPECT_EQ(translated("mark {} of {}   ", 1, 3), "mark 1 of 3   ");
}

TEST_F(Translated, a_translation_whose_fields_do_not_fit_is_not_used) {
    const std::filesystem::path folder = std::filesystem::path(testing::TempDir()) / "palpate_texts";
    const auto messages = folder / "de/LC_MESSAGES";
    std::filesystem::create_directories(messages);
    std::ofstream(folder / "wrong.po")
        << "msgid \"\"\nmsgstr \"Content-Type: text/plain; charset=UTF-8\\n\"\n"
        << "msgid \"picture: {}\"\nmsgstr \"Bild: {} {}\"\n";
    const std::string command = std::string(PALPATE_MSGFMT) + " -o " + (messages / "palpate.mo").string() +
                                " " + (folder / "wrong.po").string();
    ASSERT_EQ(std::system(command.c_str()), 0);
    speak("de");
    bindtextdomain("palpate", folder.c_str());
    EXPECT_EQ(looked_up("picture: {}"), "Bild: {} {}");
    EXPECT_EQ(translated("picture: {}", "a.png"), "picture: a.png");
    std::filesystem::remove_all(folder);
}

}  // namespace
}  // namespace palpate
