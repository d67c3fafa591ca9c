// SPDX-License-Identifier: Apache-2.0
#include <array>
#include <fstream>
#include <gmock/gmock.h>
#include <gtest/gtest.h>

#include "formats/asset/asset.hpp"
#include "formats/asset/hdf5/signature.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/formats/unchecked_body.hpp"

namespace palpate {
namespace {

using namespace asset;
using sample::refusal;
using sample::Scratch;
using ::testing::ElementsAre;
using ::testing::HasSubstr;

// The keys of RFC 8032, section 7.1, tests 1 and 2, in PEM.
constexpr const char* first_private =
    "-----BEGIN PRIVATE KEY-----\nMC4CAQAwBQYDK2VwBCIEIJ1hsZ3v/VpguoRK9JLsLMREScVpezJpGXA7rAMcrn9g\n"
    "-----END PRIVATE KEY-----\n";
constexpr const char* first_public =
    "-----BEGIN PUBLIC KEY-----\nMCowBQYDK2VwAyEA11qYAYKxCrfVS/7TyWQHOg7hcvPapiMlrwIaaPcHURo=\n"
    "-----END PUBLIC KEY-----\n";
constexpr const char* first_key = "d75a980182b10ab7d54bfed3c964073a0ee172f3daa62325af021a68f707511a";
const std::string other_key = "3d4017c3e843895a92b70aa74d1b7ebc9c982ccf2ec4968cc0cd55f12af4660c";
const std::string digest(64, 'a');

std::filesystem::path written(const std::filesystem::path& file, const std::string& text) {
    std::ofstream(file) << text;
    return file;
}

struct Signing : ::testing::Test {
    Scratch scratch;
    std::filesystem::path key = written(scratch / "key.pem", first_private);
};

TEST_F(Signing, is_of_the_key_that_the_standard_derives_and_the_same_each_time) {
    const Signature signature = sign_manifest(digest, key);
    EXPECT_EQ(signature.public_key, first_key);
    EXPECT_EQ(signature.signature, sign_manifest(digest, key).signature);
    EXPECT_TRUE(is_signed(digest, signature));
}

TEST_F(Signing, reads_no_key_out_of_what_is_no_small_file) {
    const auto refused = [](const std::filesystem::path& file) {
        return refusal([&] { sign_manifest(digest, file); }) + refusal([&] { read_public_keys({&file, 1}); });
    };
    EXPECT_THAT(refused("/dev/zero"), HasSubstr("/dev/zero: is a device"));
    EXPECT_THAT(refused(scratch / "."), HasSubstr("is a folder"));
    std::filesystem::resize_file(key, most_key_bytes + 1);
    EXPECT_THAT(refused(key), HasSubstr("has 65537 bytes (expected 65536 at most)"));
}

TEST_F(Signing, does_not_hold_for_anything_else) {
    const Signature good = sign_manifest(digest, key);
    EXPECT_FALSE(is_signed(std::string(64, 'b'), good));
    EXPECT_FALSE(is_signed(digest, {good.signature, other_key}));
    Signature changed = good;
    changed.signature[7] = changed.signature[7] == '0' ? '1' : '0';
    EXPECT_FALSE(is_signed(digest, changed));
    for (const std::string text : {"", "zz", "00"}) {
        EXPECT_FALSE(is_signed(digest, {text, good.public_key}));
        EXPECT_FALSE(is_signed(digest, {good.signature, text}));
    }
    EXPECT_FALSE(is_signed(digest, {std::string(128, 'g'), std::string(64, 'g')}));
}

TEST_F(Signing, takes_keys_of_its_kind_alone) {
    const auto nothing = written(scratch / "nothing.pem", "no key\n");
    EXPECT_THAT(refusal([&] { sign_manifest(digest, nothing); }), HasSubstr("holds no private key"));
    const auto open_key = written(scratch / "public.pem", first_public);
    EXPECT_THAT(refusal([&] { sign_manifest(digest, open_key); }), HasSubstr("holds no private key"));
    EXPECT_THAT(refusal([&] { sign_manifest(digest, scratch / "missing.pem"); }),
                HasSubstr("cannot be read"));
    EXPECT_THAT(refusal([&] { read_public_keys(std::array{nothing}); }),
                HasSubstr("holds no public key that is whole"));
    EXPECT_THAT(refusal([&] { read_public_keys(std::array{key}); }), HasSubstr("holds no public keys alone"));
    const auto torn =
        written(scratch / "torn.pem",
                std::string(first_public) + "-----BEGIN PUBLIC KEY-----\nMCow\n-----END PUBLIC KEY-----\n");
    EXPECT_THAT(refusal([&] { read_public_keys(std::array{torn}); }), HasSubstr("holds no public key"));
    const auto two = written(scratch / "two.pem", std::string(first_public) + first_public);
    EXPECT_THAT(read_public_keys(std::array{two}), ElementsAre(first_key, first_key));
}

struct SignedAsset : Signing {
    std::filesystem::path signed_asset = scratch / "signed.vtkhdf", plain = scratch / "plain.vtkhdf";
    SignedAsset() {
        write_asset(signed_asset, sample::sample_case(1), key);
        write_asset(plain, sample::sample_case(1));
    }
};

TEST_F(SignedAsset, is_read_by_those_who_trust_its_key) {
    EXPECT_EQ(signer_of(signed_asset), first_key);
    EXPECT_EQ(signer_of(plain), std::nullopt);
    EXPECT_EQ(read_asset(signed_asset).name, "sample");
    EXPECT_EQ(read_asset(signed_asset, std::array{other_key, std::string(first_key)}).name, "sample");
    EXPECT_EQ(load_asset(signed_asset, std::array{std::string(first_key)}).name, "sample");
    EXPECT_EQ(asset_digest(signed_asset), asset_digest(plain));
}

TEST_F(SignedAsset, is_refused_by_those_who_do_not) {
    EXPECT_THAT(refusal([&] { read_asset(signed_asset, std::array{other_key}); }),
                HasSubstr(std::string("is signed by ") + first_key));
    EXPECT_THAT(refusal([&] { read_asset(plain, std::array{other_key}); }), HasSubstr("is not signed"));
    EXPECT_THAT(refusal([&] { load_asset(plain, std::array{other_key}); }), HasSubstr("is not signed"));
}

}  // namespace
}  // namespace palpate
