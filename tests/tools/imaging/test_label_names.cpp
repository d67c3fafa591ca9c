// SPDX-License-Identifier: GPL-3.0-or-later
#include <gtest/gtest.h>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/tools/imaging/hand_written_images.hpp"
#include "tests/tools/imaging/refusals.hpp"
#include "tools/imaging/files/image_files.hpp"
#include "tools/imaging/files/label_names.hpp"

namespace palpate {
namespace {

using namespace imaging;
using sample::Scratch;
using test::write_bytes;

LabelMap bare_map() {
    LabelMap map;
    map.grid.size = {4, 5, 6};
    map.labels.assign(map.grid.voxel_count(), 0);
    map.labels[7] = 1;
    map.labels[50] = 5;
    map.names = {{1, "label_1", {}}, {5, "label_5", {}}};
    return map;
}

TEST(LabelNames, every_kind_of_table_names_the_same_labels) {
    const Scratch folder;
    const std::map<std::string, std::string> tables{
        {"slicer.ctbl",
         "# Color table file\n# 3 values\n0 Background 0 0 0 0\n1 spleen 255 0 51 255\n5 liver 0 255 0 "
         "255\n"},
        {"snap.label",
         "# ITK-SnAP Label Description File\n    0     0    0    0        0  0  0    \"Clear Label\"\n"
         "    1   255    0   51        1  1  1    \"spleen\"\n    5     0  255    0        1  1  1    "
         "\"liver\"\n"},
        {"dseg.tsv", "index\tname\tcolor\n1\tspleen\t#ff0033\n5\tliver\t#00ff00\n9\tunused\t#000000\n"},
        {"other_columns.tsv", "name\tmapping\tindex\tcolor\nspleen\t2\t1\t#ff0033\nliver\t3\t5\t#00ff00\n"},
        {"values.json", "{\"1\": \"spleen\", \"5\": \"liver\"}"},
        {"nnunet.json", "{\"labels\": {\"background\": 0, \"spleen\": 1, \"liver\": 5}, \"numTraining\": 3}"},
        {"aal.txt", "1 spleen 2001\n5 liver 2002\n"}};
    for (const auto& [name, text] : tables) {
        SCOPED_TRACE(name);
        write_bytes(folder / name, text);
        LabelMap map = bare_map();
        name_labels(map, folder / name);
        ASSERT_EQ(map.names.size(), 2U);
        EXPECT_EQ(map.names[0].name, "spleen");
        EXPECT_EQ(map.names[1].name, "liver");
        EXPECT_EQ(map.names[1].value, 5);
        const bool coloured = text.find("255") != std::string::npos || name.ends_with(".tsv");
        const auto expected = coloured ? std::array<float, 3>{1, 0, 0.2F} : default_label_colour(1);
        EXPECT_EQ(map.names[0].colour, expected);
    }
}

TEST(LabelNames, totalsegmentator_values_mean_what_their_version_and_task_say) {
    const auto name = [](const char* task, int value) { return totalsegmentator_table(task).at(value).name; };
    EXPECT_EQ(name("v1/total", 43), "trachea");
    EXPECT_EQ(name("v2/total", 16), "trachea");
    EXPECT_EQ(name("v1/total", 50), "brain");
    EXPECT_EQ(name("v2/total", 90), "brain");
    EXPECT_EQ(name("v2/total", 91), "skull");
    EXPECT_EQ(name("v2/total_mr", 50), "brain");
    EXPECT_EQ(name("v2/head_glands_cavities", 11), "nasopharynx");
    EXPECT_EQ(name("v2/pleural_pericard_effusion", 2), "pleural_effusion");
    for (const auto& [task, count] : std::map<std::string, std::size_t>{
             {"v1/total", 104}, {"v2/total", 117}, {"v2/total_mr", 50}, {"v2/head_glands_cavities", 19}})
        EXPECT_EQ(totalsegmentator_table(task).size(), count) << task;
    const std::string refusal = test::refusal_of<Error>([] { totalsegmentator_table("total"); });
    EXPECT_NE(refusal.find("v2/total"), std::string::npos) << refusal;
    LabelMap map = bare_map();
    name_labels(map, "totalsegmentator:v2/total");
    EXPECT_EQ(map.names[1].name, "liver");
}

TEST(LabelNames, what_a_table_does_not_know_keeps_its_name_with_a_note) {
    const Scratch folder;
    write_bytes(folder / "t.txt", "5 liver\n");
    LabelMap map = bare_map();
    std::string notes;
    name_labels(map, folder / "t.txt", [&](std::string_view note) { notes += note; });
    EXPECT_EQ(map.names[0].name, "label_1");
    EXPECT_EQ(map.names[1].name, "liver");
    EXPECT_NE(notes.find("no name for 1"), std::string::npos) << notes;
    write_bytes(folder / "t.txt", "8 lung\n");
    EXPECT_NE(test::refusal_of<Error>([&] { name_labels(map, folder / "t.txt"); }).find("none of the values"),
              std::string::npos);
}

TEST(LabelNames, malformed_tables_are_refused_with_their_line) {
    const Scratch folder;
    const auto refusal = [&](const std::string& text) {
        write_bytes(folder / "t.txt", text);
        return test::refusal_of<Error>([&] { read_label_table(folder / "t.txt"); });
    };
    EXPECT_NE(refusal("1 liver\nspleen 2\n").find("t.txt:2"), std::string::npos);
    EXPECT_NE(refusal("70000 liver\n").find("t.txt:1"), std::string::npos);
    EXPECT_NE(refusal("1\n").find("t.txt:1"), std::string::npos);
    EXPECT_NE(refusal("1 255 0 0 1 1 1 \"liver\n").find("t.txt:1"), std::string::npos);
    EXPECT_NE(refusal("# nothing\n").find("names no label"), std::string::npos);
    EXPECT_NE(refusal("{\"liver\": [5]}").find("no JSON label table"), std::string::npos);
    EXPECT_NE(refusal("{\"1\": ").find("no JSON label table"), std::string::npos);
    LabelMap map = bare_map();
    EXPECT_NE(
        test::refusal_of<Error>([&] { name_labels(map, "absent.ctbl"); }).find("'absent.ctbl' is no file"),
        std::string::npos);
}

TEST(LabelNames, names_may_have_blanks_and_what_is_ambiguous_is_refused) {
    const Scratch folder;
    const auto name = [&](const std::string& line) {
        write_bytes(folder / "t.txt", line + "\n");
        return read_label_table(folder / "t.txt").at(1).name;
    };
    EXPECT_EQ(name("1 left kidney"), "left kidney");
    EXPECT_EQ(name("1 left kidney 255 0 0 255"), "left kidney");
    EXPECT_EQ(name("1 left kidney 255 0 0"), "left kidney");
    EXPECT_EQ(name("1 left rib 7 255 0 0 255"), "left rib 7");
    EXPECT_EQ(name("1 3rd ventricle 2001"), "3rd ventricle");
    EXPECT_EQ(name("\xEF\xBB\xBFindex\tname\n1\tleft kidney"), "left kidney");
    for (const char* line : {"1 2 liver", "1 vertebra 5", "1 rib 7 8", "1 255 0 0 255"}) {
        SCOPED_TRACE(line);
        EXPECT_THROW(name(line), InvalidInput);
    }
    EXPECT_THROW(name("{\"labels\": {\"liver\": 4294967297}}"), InvalidInput);
}

TEST(LabelNames, an_xml_of_many_openings_is_read_once) {
    std::string xml;
    for (int n = 0; n < 200000; ++n) xml += "<Label >";
    const std::string good = "<Label Key=\"5\">liver</Label>";
    EXPECT_EQ(parse_xml_label_table(xml + "</Label>" + good).at(5).name, "liver");
    EXPECT_TRUE(parse_xml_label_table("<Label Key=\"5\">" + std::string(10000, 'a') + "</Label>").empty());
}

TEST(LabelNames, repeated_names_get_numbers) {
    LabelMap map = bare_map();
    map.names[0].name = map.names[1].name = "vein";
    std::string notes;
    make_names_unique(map, [&](std::string_view note) { notes += note; });
    EXPECT_EQ(map.names[0].name, "vein");
    EXPECT_EQ(map.names[1].name, "vein_2");
    EXPECT_NE(notes.find("1 labels repeat"), std::string::npos);
}

TEST(LabelNames, the_label_table_of_a_nifti_header_extension_is_read) {
    const Scratch folder;
    const LabelMap map = bare_map();
    const std::string xml =
        "<CaretExtension><VolumeInformation><LabelTable>\n"
        "<Label Key=\"1\" Red=\"1\" Green=\"0.5\" Blue=\"0\" Alpha=\"1\"><![CDATA[spleen]]></Label>\n"
        "<Label Key=\"5\" Red=\"0\" Green=\"1\" Blue=\"0\" Alpha=\"1\">liver</Label></LabelTable>";
    std::vector<float> real(map.labels.begin(), map.labels.end());
    std::string file = test::nifti_file(map.grid, test::raw_bytes<float>(real));
    const std::string block = xml + std::string(16 - (xml.size() + 8) % 16, ' ');
    std::string extension(8, '\0');
    const auto size = static_cast<std::int32_t>(block.size() + 8);
    std::memcpy(extension.data(), &size, 4);
    file.insert(352, extension + block);
    file[348] = 1;
    const auto offset = static_cast<float>(352 + size);
    std::memcpy(file.data() + 108, &offset, 4);
    write_bytes(folder / "l.nii", file);
    const LabelMap read = read_label_map(folder / "l.nii");
    EXPECT_EQ(read.labels, map.labels);
    ASSERT_EQ(read.names.size(), 2U);
    EXPECT_EQ(read.names[0].name, "spleen");
    EXPECT_EQ(read.names[0].colour, (std::array<float, 3>{1, 0.5, 0}));
    EXPECT_EQ(read.names[1].name, "liver");
}

}  // namespace
}  // namespace palpate
