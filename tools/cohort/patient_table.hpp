// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <iosfwd>
#include <string>
#include <vector>

#include "tools/case_builder/overrides.hpp"

namespace palpate::cohort {

/// One row of a table of patients.
struct Patient {
    std::string name;                 ///< of the outputs
    bool named = false;               ///< whether it can name files: it is safe and nobody else's
    std::filesystem::path case_path;  ///< absolute
    std::vector<case_builder::Override> overrides;  ///< the row's cells that are not empty
    std::string where;                              ///< "patients.tsv:7"
    std::string mistake;                            ///< what is wrong with the row; empty if nothing
};

/// Reads a tab-separated table whose first line names its columns: `patient` (letters, digits, '.', '_',
/// '-'), `case` (a case file), and any of `volume`, `labels`, `label_names` and dotted keys of case files
/// ("deformable.liver.mesh.cell_size_mm"), whose cells go before the case file's values where they are not
/// empty. A row whose `problem` is not empty has that as its mistake. Columns that begin with '#' are for
/// people. Paths are absolute or relative to the table. Throws InvalidInput naming the column for a head that
/// cannot be used and for a cell that is no UTF-8; a row that cannot be keeps its mistake.
std::vector<Patient> read_patient_table(const std::filesystem::path& path);

/// The same of a table that is not written yet, or not there; `path` is where it would be.
std::vector<Patient> parse_patient_table(std::istream& stream, const std::filesystem::path& path);

}  // namespace palpate::cohort
