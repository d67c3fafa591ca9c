// SPDX-License-Identifier: GPL-3.0-or-later
#pragma once
#include <filesystem>
#include <map>
#include <span>
#include <string>
#include <string_view>

#include "formats/model/label_map.hpp"
#include "tools/imaging/files/image_files.hpp"

namespace palpate::imaging {

/// What values mean; colours are default_label_colour() where a source names none.
using LabelTable = std::map<std::int32_t, Label>;

/// Reads "5=liver,4=gallbladder"; throws UsageError if it is malformed or names a value or a name twice.
std::map<std::int32_t, std::string> parse_label_names(std::string_view text);

/// Names labels by value and turns all others into background. Throws InvalidInput if a value does not
/// occur in the map.
void rename_labels(LabelMap& map, const std::map<std::int32_t, std::string>& names);

/// Reads the labels of a Caret/Connectome Workbench label table, <Label Key="5" Red=".." ..>liver</Label>, in
/// any XML or none; one longer than 4096 characters is left out. Cost: linear.
LabelTable parse_xml_label_table(std::string_view xml);

/// Reads a label table, whichever it is: 3D Slicer's .ctbl and FreeSurfer's (value name R G B A), ITK-SNAP's
/// label descriptions (value R G B A visible mesh "name"), BIDS' _dseg.tsv (columns index, name and perhaps
/// color), JSON ({"5": "liver"} or {"labels": {"liver": 5}}), or lines "value name". Background is left out.
/// A name may have blanks; of numbers behind it three or four are a colour and a single one of 1000 or more
/// is a code. Throws InvalidInput naming file and line for anything else or a value beyond 65535.
LabelTable read_label_table(const std::filesystem::path& path);

/// A BIDS _dseg.tsv of labels: columns index, name and color ("#ff8000"), in the order given. A tab or line
/// break in a name becomes a blank. read_label_table() reads the same values, names and, to 1/510, colours.
std::string bids_label_table(std::span<const Label> labels);

/// TotalSegmentator's table of a version and task, "v2/total"; throws InvalidInput naming the nearest ones.
LabelTable totalsegmentator_table(std::string_view task);

/// Names the labels of a map after `source`: "5=liver,4=gallbladder" as rename_labels() does, or
/// "totalsegmentator:v2/total", or the path of a label table, whose further names are ignored; labels that a
/// table does not know keep theirs, with a note. An empty source changes nothing and notes labels without
/// name. Throws as those do, UsageError if the source is none of them, and InvalidInput if a table knows
/// none.
void name_labels(LabelMap& map, const std::string& source, const NoteSink& note = {});

/// Appends _2, _3 ... to names that occurred before, with a note.
void make_names_unique(LabelMap& map, const NoteSink& note);

}  // namespace palpate::imaging
