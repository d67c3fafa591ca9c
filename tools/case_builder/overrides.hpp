// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <string>

namespace palpate::case_builder {

/// A value that goes before a case file's own: "deformable.liver.mesh.cell_size_mm" = "8".
struct Override {
    std::string key;             ///< dotted; an element of an array of tables is called by its name or label
    std::string value;           ///< as TOML writes it; what is none of TOML's values is text
    std::filesystem::path file;  ///< in which it is written: paths in it are as from that file's folder
    int line = 1;                ///< in that file
};

/// Takes "KEY=VALUE" apart; `file` and `line` as in Override. Throws UsageError naming the text if it has no
/// key.
Override parse_override(const std::string& text, const std::filesystem::path& file, int line);

}  // namespace palpate::case_builder
