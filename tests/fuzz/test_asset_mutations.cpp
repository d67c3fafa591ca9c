// SPDX-License-Identifier: Apache-2.0
// Thousands of damaged assets, seeded: each must read or be refused. Under the asan preset a stray read or
// write ends the test. Headers get their checksums put right, so that what lies behind them is tried too.
#include <algorithm>
#include <array>
#include <cstring>
#include <gtest/gtest.h>
#include <random>
#include <utility>

#include "formats/asset/asset.hpp"
#include "formats/asset/hdf5/byte_cursor.hpp"
#include "formats/asset/hdf5/hdf5_file.hpp"
#include "tests/formats/sample_case.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/fuzz/allocation_gauge.hpp"
#include "tests/fuzz/look_at.hpp"

namespace palpate {
namespace {

using namespace asset;

using Bytes = std::vector<char>;

// How the body's compliance is stored.
enum class Form { dense, hierarchical };

Bytes small_asset(const sample::Scratch& scratch, Form form) {
    Case patient_case = sample::sample_case(2);
    if (form == Form::hierarchical) {  // 17 contact nodes in clusters of 2 or 3, the tightest there are
        constexpr double accuracy = 1e-3;
        DeformableBody& wall = patient_case.deformable_bodies[0];
        wall = sample::with_hierarchical_compliance(wall, 3, accuracy);
    }
    RigidBody& skull = patient_case.rigid_bodies[0];
    skull.surface = sample::sphere_surface({40, 10, 10}, 15, 1);
    skull.obb_tree = sample::median_tree(skull.surface, 4);
    write_asset(scratch / "case.vtkhdf", patient_case);
    return sample::read_bytes(scratch / "case.vtkhdf");
}

// A checksummed block of the file: superblock, object header or continuation, without its checksum.
struct Block {
    std::size_t start, size;
};

std::vector<Block> checksummed_blocks(const Bytes& bytes) {
    std::vector<Block> blocks;
    const auto view = std::as_bytes(std::span(bytes));
    constexpr std::size_t smallest = 8, largest = 8192;
    for (std::size_t at = 0; at + 4 < bytes.size(); ++at) {
        const bool header =
            std::memcmp(&bytes[at], "OHDR", 4) == 0 || std::memcmp(&bytes[at], "OCHK", 4) == 0;
        if (at != 0 && !header) continue;
        for (std::size_t size = smallest; size <= largest && at + size + 4 <= bytes.size(); ++size) {
            std::uint32_t stored = 0;
            std::memcpy(&stored, &bytes[at + size], 4);
            if (stored != lookup3(view.subspan(at, size))) continue;
            blocks.push_back({at, size});
            break;
        }
    }
    return blocks;
}

// The numbers that say where a compliance's blocks are, a small part of the file that chance would rarely
// hit; none of a dense one.
std::vector<Block> arrays_of_blocks(const std::filesystem::path& path) {
    std::vector<Block> arrays;
    const Hdf5File file(path);
    for (const char* name : {"order", "first_child", "rank", "block_values", "block_factors"}) {
        const std::string array = std::string("/palpate/bodies/deformable/0/compliance/") + name;
        if (!file.contains(array)) continue;
        const std::span<const std::byte> bytes = file.objects().at(array).values->bytes;
        arrays.push_back(
            {static_cast<std::size_t>(bytes.data() - file.mapping().bytes().data()), bytes.size()});
    }
    return arrays;
}

class Mutator {
  public:
    Mutator(const Bytes& original, std::vector<Block> arrays, unsigned seed)
        : original_(original),
          blocks_(checksummed_blocks(original)),
          arrays_(std::move(arrays)),
          random_(seed) {}

    std::size_t block_count() const { return blocks_.size(); }

    Bytes next() {
        Bytes bytes = original_;
        switch (below(arrays_.empty() ? 4 : 6)) {
            case 0:
                bytes.resize(below(bytes.size()));
                break;
            case 1:
                for (std::size_t flips = 1 + below(8); flips > 0; --flips) damage(bytes, 0, bytes.size());
                break;
            case 4:
            case 5: {
                const Block array = arrays_[below(arrays_.size())];
                for (std::size_t flips = 1 + below(3); flips > 0; --flips)
                    damage(bytes, array.start, array.size);
                break;
            }
            default: {
                const Block block = blocks_[below(blocks_.size())];
                for (std::size_t flips = 1 + below(3); flips > 0; --flips)
                    damage(bytes, block.start, block.size);
                const std::uint32_t sum =
                    lookup3(std::as_bytes(std::span(bytes)).subspan(block.start, block.size));
                std::memcpy(&bytes[block.start + block.size], &sum, 4);
            }
        }
        return bytes;
    }

  private:
    std::size_t below(std::size_t end) {
        return std::uniform_int_distribution<std::size_t>(0, end - 1)(random_);
    }

    void damage(Bytes& bytes, std::size_t start, std::size_t size) {
        constexpr std::array<std::uint64_t, 8> telling{
            0, 1, ~0ULL, 1ULL << 31, 1ULL << 32, 1ULL << 62, 1ULL << 63, 0x7FF8000000000000};
        const std::size_t at = start + below(size);
        switch (below(3)) {
            case 0:
                bytes[at] = static_cast<char>(bytes[at] ^ (1 << below(8)));
                break;
            case 1:
                bytes[at] = static_cast<char>(below(256));
                break;
            default: {
                const std::size_t width =
                    std::min<std::size_t>(std::size_t{1} << below(4), start + size - at);
                std::memcpy(&bytes[at], &telling[below(telling.size())], width);
            }
        }
    }

    const Bytes& original_;
    std::vector<Block> blocks_, arrays_;
    std::mt19937 random_;
};

struct Outcome {
    int read = 0;
    int refused = 0;
};

void use(const Case& patient_case) {
    if (const auto& scan = patient_case.scan) {
        EXPECT_EQ(scan->values.size(), scan->grid.voxel_count());
    }
    fuzz::look_at(patient_case);
}

Outcome read_mutations(Form form, Digests digests, int count, unsigned seed) {
    const sample::Scratch scratch;
    const Bytes original = small_asset(scratch, form);
    Mutator mutator(original, arrays_of_blocks(scratch / "case.vtkhdf"), seed);
    EXPECT_GT(mutator.block_count(), 60U);  // superblock, groups and datasets
    const auto path = scratch / "mutated.vtkhdf";
    Outcome outcome;
    reset_largest_allocation();
    for (int i = 0; i < count; ++i) {
        sample::write_bytes(path, mutator.next());
        try {
            use(read_asset(path, digests));
            ++outcome.read;
        } catch (const InvalidInput& error) {
            ++outcome.refused;
            EXPECT_NE(std::string(error.what()).find("mutated.vtkhdf"), std::string::npos) << error.what();
        }
    }
    // Every array is at most as large as the file; a growing vector doubles.
    EXPECT_LT(largest_allocation(), 2 * original.size() + 65536);
    return outcome;
}

TEST(MutatedAsset, reads_or_is_refused_with_digests_checked) {
    const Outcome outcome = read_mutations(Form::dense, Digests::check, 5000, 20240611);
    EXPECT_GT(outcome.refused, 4000);
}

TEST(MutatedAsset, reads_or_is_refused_with_digests_skipped) {
    const Outcome outcome = read_mutations(Form::dense, Digests::skip, 5000, 7);
    EXPECT_GT(outcome.refused, 2500);
    EXPECT_GT(outcome.read, 50);  // or the mutations would never get past the container
}

TEST(MutatedAsset, with_a_compliance_by_blocks_reads_or_is_refused_with_digests_checked) {
    const Outcome outcome = read_mutations(Form::hierarchical, Digests::check, 5000, 20240612);
    EXPECT_GT(outcome.refused, 4000);
}

TEST(MutatedAsset, with_a_compliance_by_blocks_reads_or_is_refused_with_digests_skipped) {
    const Outcome outcome = read_mutations(Form::hierarchical, Digests::skip, 5000, 8);
    EXPECT_GT(outcome.refused, 2500);
    EXPECT_GT(outcome.read, 50);
}

}  // namespace
}  // namespace palpate
