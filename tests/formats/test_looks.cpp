// SPDX-License-Identifier: Apache-2.0
// What an asset holds for the eye alone: scan and colours.
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <limits>
#include <span>

#include "formats/asset/asset.hpp"
#include "formats/asset/looks_io.hpp"
#include "formats/asset/parts.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace asset;
using sample::refusal;
using sample::Scratch;
using ::testing::HasSubstr;

constexpr double nan = std::numeric_limits<double>::quiet_NaN();

TEST(Colour, is_read_as_it_is_written_and_nothing_else_is) {
    const Colour colour{122, 58, 255};
    EXPECT_EQ(colour_text(colour), "#7a3aff");
    EXPECT_EQ(parse_colour("#7a3aff"), colour);
    EXPECT_EQ(parse_colour("#7A3aFF"), colour);
    for (const char* text : {"", "#", "7a3aff", "#7a3af", "#7a3aff0", "#7a3ag0", "#-a3aff", "#7a 3ff", "red"})
        EXPECT_FALSE(parse_colour(text)) << text;
}

TEST(Scan, is_read_as_it_was_written) {
    const Scratch scratch;
    Case written = sample::sample_case(2);
    for (const bool hounsfield : {true, false}) {
        written.scan->hounsfield = hounsfield;
        write_asset(scratch / "case.vtkhdf", written);
        const auto read = read_asset(scratch / "case.vtkhdf").scan;
        ASSERT_TRUE(read);
        EXPECT_EQ(read->grid.size, written.scan->grid.size);
        EXPECT_EQ(read->grid.spacing, written.scan->grid.spacing);
        EXPECT_EQ(read->grid.origin, written.scan->grid.origin);
        EXPECT_EQ(read->grid.direction, written.scan->grid.direction);
        EXPECT_EQ(read->values, written.scan->values);
        EXPECT_EQ(read->hounsfield, hounsfield);
    }
}

// As the specification has it: rows are k, columns i, and HU are told from other grey values by their unit.
TEST(Scan, lies_in_the_file_as_its_specification_says) {
    const Scratch scratch;
    write_asset(scratch / "case.vtkhdf", sample::sample_case(2));
    const Hdf5File file(scratch / "case.vtkhdf");
    const auto voxels = file.dataset<std::int16_t>("/palpate/scan/voxels", {8, 9, 16});
    EXPECT_EQ(voxels[(3 * 9 + 2) * 16 + 5], 200 + 40 + 30 - 300);
    EXPECT_EQ(file.text_attribute("/palpate/scan/voxels", "unit"), "HU");
    const auto direction = file.dataset<double>("/palpate/scan/direction", {3, 3});
    EXPECT_EQ(direction[1], sample::made_up_scan().grid.direction(0, 1));
}

TEST(Scan, is_left_out_of_a_file_of_the_same_schema_where_there_is_none) {
    const Scratch scratch;
    Case written = sample::sample_case(2);
    written.scan.reset();
    write_asset(scratch / "case.vtkhdf", written);
    EXPECT_FALSE(read_asset(scratch / "case.vtkhdf").scan);
    const Hdf5File file(scratch / "case.vtkhdf");
    EXPECT_FALSE(file.contains("/palpate/scan"));
    EXPECT_EQ(file.attribute<std::int32_t>("/palpate", "schema"), 2);
}

TEST(Scan, changed_by_a_voxel_is_found_out_by_its_digest) {
    const Scratch scratch;
    const auto path = scratch / "case.vtkhdf";
    write_asset(path, sample::sample_case(2));
    std::vector<char> bytes = sample::read_bytes(path);
    {
        const Hdf5File file(path);
        const auto voxels = file.dataset<std::int16_t>("/palpate/scan/voxels", {8, 9, 16});
        const auto* first = reinterpret_cast<const std::byte*>(voxels.data());
        bytes[static_cast<std::size_t>(first - file.mapping().bytes().data())] ^= 1;
    }
    sample::write_bytes(path, bytes);
    EXPECT_THAT(refusal([&] { read_asset(path); }), HasSubstr("scan/voxels: does not match its SHA-256"));
}

TEST(Scan, that_cannot_be_is_refused_when_writing_and_when_reading) {
    const Scratch scratch;
    const std::vector<std::pair<std::string, std::function<void(Scan&)>>> forgeries{
        {"origin: is not finite", [](Scan& s) { s.grid.origin[1] = nan; }},
        {"spacing: is out of range", [](Scan& s) { s.grid.spacing[0] = 0; }},
        {"spacing: is out of range", [](Scan& s) { s.grid.spacing[2] = -1; }},
        {"spacing: is out of range", [](Scan& s) { s.grid.spacing[1] = nan; }},
        {"spacing: is out of range", [](Scan& s) { s.grid.spacing[1] = 1e9; }},
        {"spacing: is out of range", [](Scan& s) { s.grid.spacing[1] = 1e-9; }},
        {"direction: is not orthonormal", [](Scan& s) { s.grid.direction(0, 1) = nan; }},
        {"direction: is not orthonormal", [](Scan& s) { s.grid.direction.col(1) *= 1.01; }},
        {"direction: is not orthonormal", [](Scan& s) { s.grid.direction.setZero(); }},
        {"direction: is not orthonormal",
         [](Scan& s) { s.grid.direction.col(2) = s.grid.direction.col(1); }}};
    for (const auto& [message, forge] : forgeries) {
        Scan forged = sample::made_up_scan();
        forge(forged);
        EXPECT_THAT(refusal([&] { check_scan(forged, "scan"); }), HasSubstr(message));
        {
            Hdf5Writer writer(scratch / "forged.h5");
            write_scan(writer, "/palpate/scan", forged);
            writer.close();
        }
        const Hdf5File file(scratch / "forged.h5");
        EXPECT_THAT(refusal([&] { read_scan(file, "/palpate/scan"); }), HasSubstr(message));
    }
}

TEST(Scan, of_either_hand_is_taken) {
    Scan scan = sample::made_up_scan();
    scan.grid.direction.col(2) *= -1;
    EXPECT_EQ(refusal([&] { check_scan(scan, "scan"); }), "");
}

TEST(Scan, of_other_sizes_than_its_values_is_refused_by_the_writer) {
    Case forged = sample::sample_case(1);
    const Scratch scratch;
    forged.scan->values.pop_back();
    EXPECT_THAT(refusal([&] { write_asset(scratch / "a", forged); }),
                HasSubstr("scan/voxels: has 1151 values (expected 1152)"));
    forged.scan->grid.size = {4096, 4096, 5};
    EXPECT_THAT(refusal([&] { write_asset(scratch / "a", forged); }), HasSubstr("83886080 voxels"));
    forged.scan->grid.size = {-16, 9, -8};
    EXPECT_THAT(refusal([&] { write_asset(scratch / "a", forged); }), HasSubstr("has 0 voxels along"));
}

TEST(Scan, too_long_too_large_or_of_another_kind_is_refused_by_the_reader) {
    const Scratch scratch;
    const auto said_of = [&](const auto& write_voxels) {
        {
            Hdf5Writer writer(scratch / "forged.h5");
            write_voxels(writer, "/palpate/scan/voxels");
            writer.close();
        }
        const Hdf5File file(scratch / "forged.h5");
        return refusal([&] { read_scan(file, "/palpate/scan"); });
    };
    const auto sized = [&](const Hdf5Shape& shape) {
        return said_of(
            [&](Hdf5Writer& writer, const std::string& path) { writer.reserve<std::int16_t>(path, shape); });
    };
    EXPECT_THAT(sized({1, 1, 4097}), HasSubstr("has 4097 voxels along an axis (expected 1 to 4096)"));
    EXPECT_THAT(sized({5, 4096, 4096}), HasSubstr("has 83886080 voxels (expected 67108864 at most)"));
    EXPECT_THAT(sized({4, 4}), HasSubstr("voxels: is int16 (4, 4)"));
    EXPECT_THAT(said_of([](Hdf5Writer& writer, const std::string& path) {
                    writer.reserve<float>(path, {2, 2, 2});
                }),
                HasSubstr("voxels: is float32"));
    EXPECT_THAT(sized({2, 2, 2}), HasSubstr("/palpate/scan/origin: is missing"));
}

TEST(Colours, of_bodies_and_regions_are_read_as_they_were_written) {
    const Scratch scratch;
    Case written = sample::sample_case(4);
    const DeformableBody& wall = written.deformable_bodies[0];
    write_asset(scratch / "case.vtkhdf", written);
    const Case read = read_asset(scratch / "case.vtkhdf");
    EXPECT_EQ(read.rigid_bodies[0].colour, written.rigid_bodies[0].colour);
    EXPECT_EQ(read.deformable_bodies[0].colour, wall.colour);
    ASSERT_EQ(read.deformable_bodies[0].region_colours.size(), 1U);
    EXPECT_EQ(read.deformable_bodies[0].region_colours[0].region, 1);
    EXPECT_EQ(read.deformable_bodies[0].region_colours[0].colour, wall.region_colours[0].colour);
}

TEST(Colours, that_nobody_gave_take_no_room_in_the_file) {
    const Scratch scratch;
    Case written = sample::sample_case(2);
    written.rigid_bodies[0].colour.reset();
    written.deformable_bodies[0].colour.reset();
    written.deformable_bodies[0].region_colours.clear();
    write_asset(scratch / "case.vtkhdf", written);
    const Hdf5File file(scratch / "case.vtkhdf");
    EXPECT_FALSE(file.has_attribute("/palpate/bodies/rigid/0", "colour"));
    EXPECT_FALSE(file.has_attribute("/palpate/bodies/deformable/0", "colour"));
    EXPECT_FALSE(file.contains("/palpate/bodies/deformable/0/drawn_regions"));
    const Case read = read_asset(scratch / "case.vtkhdf");
    EXPECT_FALSE(read.rigid_bodies[0].colour);
    EXPECT_TRUE(read.deformable_bodies[0].region_colours.empty());
}

TEST(Colours, of_regions_that_the_body_lacks_or_out_of_order_are_refused) {
    const Scratch scratch;
    for (const std::vector<RegionColour>& forged :
         {std::vector<RegionColour>{{3, {}}}, {{2, {}}, {1, {}}}, {{1, {}}, {1, {}}}}) {
        Case written = sample::sample_case(4);
        written.deformable_bodies[0].region_colours = forged;
        EXPECT_THAT(refusal([&] { write_asset(scratch / "a", written); }),
                    HasSubstr("drawn_regions: has region"));
    }
}

TEST(Colours, that_are_none_are_refused_by_the_reader) {
    const Scratch scratch;
    {
        Hdf5Writer writer(scratch / "forged.h5");
        writer.group("/body");
        writer.attribute("/body", "colour", "crimson");
        const std::vector<std::int32_t> regions{1, 2};
        for (const char* body : {"/one", "/two"})
            writer.dataset(std::string(body) + "/drawn_regions", std::span<const std::int32_t>(regions), {2});
        writer.texts("/one/drawn_colours", {"#000000", "#00000g"}, {2});
        writer.texts("/two/drawn_colours", {"#000000"}, {1});
        writer.texts("/three/drawn_colours", {"#000000"}, {1});
        writer.close();
    }
    const Hdf5File file(scratch / "forged.h5");
    EXPECT_THAT(refusal([&] { read_colour(file, "/body"); }),
                HasSubstr("/body: is a colour of 'crimson' (expected such as #7a3a2f)"));
    EXPECT_THAT(refusal([&] { read_region_colours(file, "/one"); }), HasSubstr("is a colour of '#00000g'"));
    EXPECT_THAT(refusal([&] { read_region_colours(file, "/two"); }), HasSubstr("drawn_colours: is text (1)"));
    EXPECT_THAT(refusal([&] { read_region_colours(file, "/three"); }),
                HasSubstr("drawn_regions: is missing"));
}

}  // namespace
}  // namespace palpate
