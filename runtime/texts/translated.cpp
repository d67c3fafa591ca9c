// SPDX-License-Identifier: Apache-2.0
#include "runtime/texts/translated.hpp"

#include <clocale>
#include <filesystem>
#include <libintl.h>

namespace palpate::texts {
namespace {

constexpr auto domain = "palpate";

}  // namespace

void follow_the_desktop() {
    std::setlocale(LC_MESSAGES, "");  // NOLINT(concurrency-mt-unsafe): before threads, as its comment asks
    std::error_code error;
    const auto program = std::filesystem::read_symlink("/proc/self/exe", error);
    const auto catalogues = program.parent_path().parent_path() / "share/palpate/locale";
    bindtextdomain(domain, catalogues.c_str());
    bind_textdomain_codeset(domain, "UTF-8");
}

std::string_view looked_up(const char* english) {
    return *english == '\0' ? "" : dgettext(domain, english);  // gettext answers "" with the catalogue's head
}

}  // namespace palpate::texts
