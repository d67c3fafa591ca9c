// SPDX-License-Identifier: Apache-2.0
// What is no asset, or none of this schema, and what cannot be written.
#include <csignal>
#include <filesystem>
#include <gmock/gmock.h>
#include <gtest/gtest.h>
#include <sys/resource.h>
#include <vector>

#include "formats/asset/asset.hpp"
#include "formats/asset/body_io.hpp"
#include "formats/asset/hdf5/digest.hpp"
#include "formats/asset/parts.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/formats/unchecked_body.hpp"

// HDF5 1.10 leaks a block where a file could not be written whole.
extern "C" const char* __lsan_default_suppressions() {
    return "leak:libhdf5";
}

namespace palpate {
namespace {

using namespace asset;
using sample::cells;
using sample::refusal;
using sample::Scratch;
using ::testing::HasSubstr;

TEST(Asset, a_flipped_byte_of_the_compliance_is_named) {
    const Scratch scratch;
    const auto path = scratch / "case.vtkhdf";
    write_asset(path, sample::sample_case(cells));
    std::vector<char> bytes = sample::read_bytes(path);
    const Hdf5File file(path);
    const auto data = file.objects().at("/palpate/bodies/deformable/0/compliance/dense").values->bytes;
    bytes[static_cast<std::size_t>(data.data() - file.mapping().bytes().data()) + 400] ^= 1;
    sample::write_bytes(scratch / "flipped.vtkhdf", bytes);
    const std::string message = refusal([&] { read_asset(scratch / "flipped.vtkhdf"); });
    EXPECT_THAT(message,
                HasSubstr("flipped.vtkhdf: /palpate/bodies/deformable/0/compliance/dense: does not match"));
    EXPECT_NO_THROW(read_asset(scratch / "flipped.vtkhdf", Digests::skip));
}

TEST(Asset, a_newer_schema_is_named_with_what_to_do) {
    const Scratch scratch;
    Hdf5Writer writer(scratch / "newer.vtkhdf");
    writer.group("/palpate");
    writer.attribute("/palpate", "schema", std::int32_t{3});
    writer.finish("/palpate");
    const std::string message = refusal([&] { read_asset(scratch / "newer.vtkhdf"); });
    EXPECT_THAT(message, HasSubstr("newer.vtkhdf: has schema 3 (expected at most 2); use a newer palpate"));
}

TEST(Asset, an_older_schema_is_named_with_what_to_do) {
    const Scratch scratch;
    Hdf5Writer writer(scratch / "older.vtkhdf");
    writer.group("/palpate");
    writer.attribute("/palpate", "schema", std::int32_t{1});
    writer.finish("/palpate");
    EXPECT_THAT(refusal([&] { read_asset(scratch / "older.vtkhdf"); }),
                HasSubstr("older.vtkhdf: has schema 1 (expected 2); make the file again with this palpate"));
}

TEST(Asset, a_part_is_not_a_case) {
    const Scratch scratch;
    write_body_part(scratch / "wall.body.h5", sample::elastic_cube(1));
    EXPECT_THAT(refusal([&] { read_asset(scratch / "wall.body.h5"); }),
                HasSubstr("is of kind 'body' (expected 'case'); 'palpate pack'"));
}

TEST(Asset, an_hdf5_file_of_another_program_is_refused) {
    const Scratch scratch;
    Hdf5Writer writer(scratch / "other.h5");
    writer.group("/elsewhere");
    writer.finish("/elsewhere");
    EXPECT_THAT(refusal([&] { read_asset(scratch / "other.h5"); }), HasSubstr("not one of palpate's"));
}

TEST(Asset, a_full_disk_is_a_system_failure) {
    const Scratch scratch;
    rlimit before{};
    getrlimit(RLIMIT_FSIZE, &before);
    const auto handler = std::signal(SIGXFSZ, SIG_IGN);
    const rlimit small{.rlim_cur = 50'000, .rlim_max = before.rlim_max};  // bytes: some of the asset
    setrlimit(RLIMIT_FSIZE, &small);
    EXPECT_THROW(write_asset(scratch / "case.vtkhdf", sample::sample_case(cells)), SystemFailure);
    setrlimit(RLIMIT_FSIZE, &before);
    std::signal(SIGXFSZ, handler);
}

TEST(Asset, a_missing_folder_is_a_system_failure) {
    const Scratch scratch;
    EXPECT_THROW(write_asset(scratch / "none/case.vtkhdf", sample::sample_case(1)), SystemFailure);
}

TEST(Asset, writing_refuses_parts_that_do_not_belong_together) {
    const Scratch scratch;
    Case two_of_one_name = sample::sample_case(1);
    two_of_one_name.rigid_bodies[0].name = "wall";
    EXPECT_THAT(refusal([&] { write_asset(scratch / "a", two_of_one_name); }),
                HasSubstr("two bodies 'wall'"));
    Case empty = sample::sample_case(1);
    empty.rigid_bodies.clear();
    empty.deformable_bodies.clear();
    EXPECT_THAT(refusal([&] { write_asset(scratch / "a", empty); }), HasSubstr("has no bodies"));
    Case other_tree = sample::sample_case(1);
    other_tree.rigid_bodies[0].obb_tree = other_tree.deformable_bodies[0].obb_tree;
    EXPECT_THAT(refusal([&] { write_asset(scratch / "a", other_tree); }), HasSubstr("triangle_order"));
    Case weak = sample::sample_case(1);
    weak.haptics.max_force = 0;
    EXPECT_THAT(refusal([&] { write_asset(scratch / "a", weak); }), HasSubstr("max_force is 0"));
    EXPECT_FALSE(std::filesystem::exists(scratch / "a"));
}

TEST(Digest, of_abc_is_the_standards_example) {
    // FIPS 180-4, example of SHA-256.
    EXPECT_EQ(sha256("abc"), "ba7816bf8f01cfea414140de5dae2223b00361a396177a9cb410ff61f20015ad");
}

TEST(Digest, of_a_file_is_that_of_its_bytes) {
    const Scratch scratch;
    sample::write_bytes(scratch / "abc", {'a', 'b', 'c'});
    EXPECT_EQ(sha256_file(scratch / "abc"), sha256("abc"));
    EXPECT_THAT(refusal([&] { sha256_file(scratch / "none"); }), HasSubstr("cannot be read"));
    EXPECT_THAT(refusal([&] { sha256_file(scratch / "."); }), HasSubstr("cannot be read"));
}

}  // namespace
}  // namespace palpate
