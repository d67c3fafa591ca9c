// SPDX-License-Identifier: Apache-2.0
// The container: what of HDF5 the reader takes and what it refuses. Hostile features are made with HDF5
// itself.
#include <array>
#include <cstring>
#include <functional>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <hdf5.h>

#include "formats/asset/hdf5/byte_cursor.hpp"
#include "formats/asset/hdf5/hdf5_file.hpp"
#include "formats/asset/hdf5/hdf5_writer.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate {
namespace {

using namespace asset;
using sample::refusal;
using sample::Scratch;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

void write_numbers(const std::filesystem::path& path) {
    Hdf5Writer writer(path);
    const std::array<double, 6> values{1, 2, 3, 4, 5, 6};
    writer.dataset("/group/numbers", std::span<const double>(values), {2, 3}, "mm");
    writer.texts("/group/names", {"one", "three"}, {2});
    writer.attribute("/group", "answer", std::int32_t{42});
    writer.finish("/group");
}

TEST(Hdf5File, reads_numbers_texts_and_attributes) {
    const Scratch scratch;
    write_numbers(scratch / "a.h5");
    const Hdf5File file(scratch / "a.h5");
    EXPECT_THAT(file.dataset<double>("/group/numbers", {2, 3}), ElementsAre(1, 2, 3, 4, 5, 6));
    EXPECT_THAT(file.texts("/group/names", {Hdf5File::any}), ElementsAre("one", "three"));
    EXPECT_EQ(file.attribute<std::int32_t>("/group", "answer"), 42);
    EXPECT_EQ(file.text_attribute("/group/numbers", "unit"), "mm");
    EXPECT_NO_THROW(file.check_digests("/group"));
}

TEST(Hdf5File, datasets_start_on_64_byte_boundaries) {
    const Scratch scratch;
    write_numbers(scratch / "a.h5");
    const Hdf5File file(scratch / "a.h5");
    EXPECT_EQ((file.dataset<double>("/group/numbers", {2, 3}).data() -
               reinterpret_cast<const double*>(file.mapping().bytes().data())) *
                  8 % 64,
              0);
}

TEST(Hdf5File, many_links_and_attributes_stay_readable) {
    const Scratch scratch;
    Hdf5Writer writer(scratch / "a.h5");
    for (std::int32_t i = 0; i < 300; ++i) {
        writer.group("/group/" + std::to_string(i));
        writer.attribute("/group", "attribute" + std::to_string(i), i);
    }
    writer.finish("/group");
    const Hdf5File file(scratch / "a.h5");
    EXPECT_TRUE(file.contains("/group/299"));
    EXPECT_EQ(file.attribute<std::int32_t>("/group", "attribute299"), 299);
}

TEST(Hdf5File, wrong_requests_name_the_object_and_what_was_expected) {
    const Scratch scratch;
    write_numbers(scratch / "a.h5");
    const Hdf5File file(scratch / "a.h5");
    EXPECT_THAT(refusal([&] {
                    file.dataset<double>("/group/none", {2, 3});
                }),
                HasSubstr("a.h5: /group/none: is missing"));
    EXPECT_THAT(refusal([&] {
                    file.dataset<double>("/group", {2, 3});
                }),
                HasSubstr("is a group (expected a dataset)"));
    EXPECT_THAT(refusal([&] {
                    file.dataset<float>("/group/numbers", {2, 3});
                }),
                HasSubstr("is float64 (2, 3) (expected float32 (2, 3))"));
    EXPECT_THAT(refusal([&] {
                    file.dataset<double>("/group/numbers", {Hdf5File::any, 4});
                }),
                HasSubstr("is float64 (2, 3) (expected float64 (any, 4))"));
    EXPECT_THAT(refusal([&] { file.dataset<double>("/group/numbers", {6}); }),
                HasSubstr("(expected float64 (6))"));
    EXPECT_THAT(refusal([&] { file.attribute<double>("/group", "answer"); }),
                HasSubstr("attribute 'answer' is int32"));
    EXPECT_THAT(refusal([&] { file.attribute<double>("/group", "question"); }),
                HasSubstr("lacks attribute 'question'"));
}

TEST(Hdf5File, damage_to_the_whole_file_is_named) {
    const Scratch scratch;
    write_numbers(scratch / "a.h5");
    const std::vector<char> bytes = sample::read_bytes(scratch / "a.h5");
    const auto refused = [&](std::vector<char> changed) {
        sample::write_bytes(scratch / "b.h5", changed);
        return refusal([&] { Hdf5File(scratch / "b.h5"); });
    };
    const std::string size = std::to_string(bytes.size());
    EXPECT_THAT(
        refused({bytes.begin(), bytes.end() - 1}),
        HasSubstr("is truncated: " + std::to_string(bytes.size() - 1) + " bytes (expected " + size + ")"));
    EXPECT_THAT(refused({bytes.begin(), bytes.begin() + 20}), HasSubstr("is truncated: 20 bytes"));
    EXPECT_THAT(refused({bytes.begin(), bytes.begin() + 8}), HasSubstr("is truncated: 8 bytes"));
    EXPECT_THAT(refused({}), HasSubstr("is empty"));
    EXPECT_THAT(refused({'P', 'K'}), HasSubstr("is not an HDF5 file"));
    std::vector<char> longer = bytes;
    longer.push_back(0);
    EXPECT_THAT(refused(longer), HasSubstr("has foreign bytes at its end"));
    std::vector<char> flipped = bytes;
    flipped[36] ^= 1;  // root group's address
    EXPECT_THAT(refused(flipped), HasSubstr("a header does not match its checksum"));
    EXPECT_THAT(refusal([&] { Hdf5File(scratch / "none.h5"); }), HasSubstr("No such file"));
    EXPECT_THAT(refusal([&] { Hdf5File(scratch / "."); }), HasSubstr("is not a file"));
}

// A header whose checksum was put right after changing it, as someone hostile would.
std::vector<char> with_header_number(std::vector<char> bytes, const std::string& path, std::uint64_t before,
                                     std::uint64_t after) {
    const std::string name = path.substr(path.rfind('/') + 1);
    for (std::size_t at = 0; at + 4 < bytes.size(); ++at) {
        if (std::memcmp(&bytes[at], "OHDR", 4) != 0) continue;
        ByteCursor cursor(std::as_bytes(std::span(bytes)).subspan(at + 5));
        const unsigned flags = cursor.number<std::uint8_t>();
        if (flags & 0x10U) cursor.take(4);
        const auto size = static_cast<std::size_t>(cursor.sized_number(flags));
        const std::size_t start = bytes.size() - cursor.remaining(), end = start + size;
        for (std::size_t i = start; i + 8 <= end; ++i) {
            if (std::memcmp(&bytes[i], &before, 8) != 0) continue;
            std::memcpy(&bytes[i], &after, 8);
            const std::uint32_t sum = lookup3(std::as_bytes(std::span(bytes)).subspan(at, end - at));
            std::memcpy(&bytes[end], &sum, 4);
            return bytes;
        }
    }
    ADD_FAILURE() << name << " has no header with " << before;
    return bytes;
}

TEST(Hdf5File, extents_beyond_the_file_are_refused_before_anything_is_allocated) {
    const Scratch scratch;
    const std::array<float, 77> values{};
    {
        Hdf5Writer writer(scratch / "a.h5");
        writer.dataset("/numbers", std::span<const float>(values), {7, 11});
        writer.finish("/");
    }
    const std::vector<char> bytes = sample::read_bytes(scratch / "a.h5");
    const auto refused = [&](std::uint64_t before, std::uint64_t after) {
        sample::write_bytes(scratch / "b.h5", with_header_number(bytes, "/numbers", before, after));
        return refusal([&] { Hdf5File(scratch / "b.h5"); });
    };
    constexpr std::uint64_t huge = std::uint64_t{1} << 62;
    EXPECT_THAT(refused(7, huge), HasSubstr("b.h5: /numbers: is larger than the file"));
    EXPECT_THAT(refused(7, 8), HasSubstr("/numbers: stores 308 bytes (expected 352)"));
    EXPECT_THAT(refused(308, huge), HasSubstr("stores 4611686018427387904 bytes (expected 308)"));
    const Hdf5File file(scratch / "a.h5");
    const auto address = static_cast<std::uint64_t>(file.objects().at("/numbers").values->bytes.data() -
                                                    file.mapping().bytes().data());
    EXPECT_THAT(refused(address, bytes.size() / 8 * 8),
                HasSubstr("/numbers: lies beyond the end of the file"));
    EXPECT_THAT(refused(address, huge), HasSubstr("/numbers: lies beyond the end of the file"));
    EXPECT_THAT(refused(address, address + 1), HasSubstr("8-byte boundary"));
}

TEST(Hdf5File, objects_that_share_bytes_are_refused) {
    const Scratch scratch;
    const std::array<float, 1024> values{};
    constexpr int copies = 8;  // larger together than the file
    {
        Hdf5Writer writer(scratch / "a.h5");
        for (int i = 0; i < copies; ++i)
            writer.dataset("/" + std::to_string(i), std::span<const float>(values).first(i == 0 ? 1024 : 19),
                           {i == 0 ? 1024U : 19U});
        writer.finish("/");
    }
    std::vector<char> bytes = sample::read_bytes(scratch / "a.h5");
    const Hdf5File file(scratch / "a.h5");
    const auto address = [&](const std::string& path) {
        return static_cast<std::uint64_t>(file.objects().at(path).values->bytes.data() -
                                          file.mapping().bytes().data());
    };
    for (int i = 1; i < copies; ++i) {
        const std::string path = "/" + std::to_string(i);
        bytes = with_header_number(bytes, path, address(path), address("/0"));
        bytes = with_header_number(bytes, path, 19, 1024);  // its shape
        bytes = with_header_number(bytes, path, 76, 4096);  // its size
    }
    sample::write_bytes(scratch / "b.h5", bytes);
    EXPECT_THAT(refusal([&] { Hdf5File(scratch / "b.h5"); }),
                HasSubstr("shares its bytes with other objects"));
}

TEST(Hdf5File, a_path_that_is_too_long_is_refused) {
    const Scratch scratch;
    const auto nested = [&](const char* name, int levels) {
        Hdf5Writer writer(scratch / name);
        std::string path;
        for (int level = 0; level < levels; ++level) path += "/" + std::string(50, 'a');
        writer.group(path);
        writer.finish("/");
    };
    nested("a.h5", 5);  // 255 bytes
    EXPECT_NO_THROW(Hdf5File(scratch / "a.h5"));
    nested("b.h5", 6);
    EXPECT_THAT(refusal([&] { Hdf5File(scratch / "b.h5"); }), HasSubstr("has a path that is too long"));
}

struct Feature {
    const char* name;
    std::function<void(hid_t file)> add;
    const char* message;
};

void PrintTo(const Feature& feature, std::ostream* stream) {
    *stream << feature.name;
}

class ForeignFeature : public ::testing::TestWithParam<Feature> {};

void add_dataset(hid_t file, hid_t type, hid_t creation) {
    const std::array<hsize_t, 1> size{4};
    const hid_t space = H5Screate_simple(1, size.data(), nullptr);
    H5Dclose(H5Dcreate2(file, "foreign", type, space, H5P_DEFAULT, creation, H5P_DEFAULT));
    H5Sclose(space);
}

void add_with(hid_t file, const std::function<void(hid_t)>& set_up) {
    const hid_t creation = H5Pcreate(H5P_DATASET_CREATE);
    H5Pset_obj_track_times(creation, false);
    set_up(creation);
    add_dataset(file, H5T_STD_I32LE, creation);
    H5Pclose(creation);
}

TEST_P(ForeignFeature, is_refused_by_name) {
    const Scratch scratch;
    write_numbers(scratch / "a.h5");
    const hid_t access = H5Pcreate(H5P_FILE_ACCESS);
    H5Pset_libver_bounds(access, H5F_LIBVER_V110, H5F_LIBVER_V110);
    const hid_t file = H5Fopen((scratch / "a.h5").c_str(), H5F_ACC_RDWR, access);
    GetParam().add(file);
    H5Fclose(file);
    H5Pclose(access);
    EXPECT_THAT(refusal([&] { Hdf5File(scratch / "a.h5"); }), HasSubstr(GetParam().message));
}

constexpr std::array<hsize_t, 1> chunk{2};

INSTANTIATE_TEST_SUITE_P(
    Each, ForeignFeature,
    ::testing::Values(
        Feature{"soft_link",
                [](hid_t f) { H5Lcreate_soft("/group/numbers", f, "soft", H5P_DEFAULT, H5P_DEFAULT); },
                "link 'soft' is soft (expected a hard link)"},
        Feature{
            "external_link",
            [](hid_t f) { H5Lcreate_external("/etc/passwd", "/x", f, "outside", H5P_DEFAULT, H5P_DEFAULT); },
            "link 'outside' is external (expected a hard link)"},
        Feature{"second_hard_link",
                [](hid_t f) { H5Lcreate_hard(f, "/group/numbers", f, "again", H5P_DEFAULT, H5P_DEFAULT); },
                "is linked to twice"},
        Feature{"cyclic_hard_link",
                [](hid_t f) { H5Lcreate_hard(f, "/", f, "/group/up", H5P_DEFAULT, H5P_DEFAULT); },
                "is linked to twice"},
        Feature{"external_storage",
                [](hid_t f) { add_with(f, [](hid_t p) { H5Pset_external(p, "/etc/passwd", 0, 16); }); },
                "/foreign: keeps its data in external files"},
        Feature{"chunked", [](hid_t f) { add_with(f, [](hid_t p) { H5Pset_chunk(p, 1, chunk.data()); }); },
                "/foreign: is chunked (expected contiguous)"},
        Feature{"compact", [](hid_t f) { add_with(f, [](hid_t p) { H5Pset_layout(p, H5D_COMPACT); }); },
                "/foreign: is compact (expected contiguous)"},
        Feature{"filtered",
                [](hid_t f) {
                    add_with(f, [](hid_t p) {
                        H5Pset_chunk(p, 1, chunk.data());
                        H5Pset_fletcher32(p);
                    });
                },
                "/foreign: is "},
        Feature{"virtual_dataset",
                [](hid_t f) {
                    add_with(f, [](hid_t p) {
                        const std::array<hsize_t, 1> size{4};
                        const hid_t space = H5Screate_simple(1, size.data(), nullptr);
                        H5Pset_virtual(p, space, "other.h5", "/x", space);
                        H5Sclose(space);
                    });
                },
                "/foreign: is virtual (expected contiguous)"},
        Feature{"variable_length_text",
                [](hid_t f) {
                    const hid_t type = H5Tcopy(H5T_C_S1);
                    H5Tset_size(type, H5T_VARIABLE);
                    add_dataset(f, type, H5P_DEFAULT);
                    H5Tclose(type);
                },
                "/foreign: is text of variable length"},
        Feature{"big_endian", [](hid_t f) { add_dataset(f, H5T_STD_I32BE, H5P_DEFAULT); },
                "has a type of class 0"},
        Feature{"named_type",
                [](hid_t f) {
                    const hid_t type = H5Tcopy(H5T_STD_I32LE);
                    H5Tcommit2(f, "type", type, H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT);
                    H5Tclose(type);
                },
                "lacks its type, its shape or its storage"},
        Feature{"dense_links",
                [](hid_t f) {
                    const hid_t p = H5Pcreate(H5P_GROUP_CREATE);
                    H5Pset_link_phase_change(p, 0, 0);
                    const hid_t dense = H5Gcreate2(f, "dense", H5P_DEFAULT, p, H5P_DEFAULT);
                    H5Gclose(H5Gcreate2(dense, "inner", H5P_DEFAULT, H5P_DEFAULT, H5P_DEFAULT));
                    H5Gclose(dense);
                    H5Pclose(p);
                },
                "/dense: keeps its links outside its header"}),
    [](const auto& info) { return std::string(info.param.name); });

TEST(Hdf5File, a_file_of_the_old_layout_is_refused) {
    const Scratch scratch;
    H5Fclose(H5Fcreate((scratch / "old.h5").c_str(), H5F_ACC_TRUNC, H5P_DEFAULT, H5P_DEFAULT));
    EXPECT_THAT(refusal([&] { Hdf5File(scratch / "old.h5"); }),
                HasSubstr("HDF5 superblock version 0 (expected 2 or 3)"));
}

TEST(Lookup3, agrees_with_its_authors_examples) {
    // Jenkins, lookup3.c, driver5(): hashlittle() with initial value 0.
    const std::string text = "Four score and seven years ago";
    EXPECT_EQ(lookup3(std::as_bytes(std::span(text))), 0x17770551U);
    EXPECT_EQ(lookup3({}), 0xdeadbeefU);
}

}  // namespace
}  // namespace palpate
