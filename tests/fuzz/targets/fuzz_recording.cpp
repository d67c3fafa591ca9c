// SPDX-License-Identifier: Apache-2.0
// Recordings of runs.
#include "formats/recording/recording.hpp"
#include "tests/fuzz/feed.hpp"
#include "tests/fuzz/hdf5_mutator.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size) {
    using namespace palpate;
    constexpr fuzz::MemoryCap cap{.factor = 32, .base = std::size_t{1} << 16};
    fuzz::feed({data, size}, "fuzzed.h5", cap, [](const std::filesystem::path& path) {
        const recording::Recording run = recording::read_recording(path);
        double sum = 0;
        for (const Tick& tick : run.ticks)
            for (const Contact& contact : run.contacts_of(tick)) sum += contact.force;
        static_cast<void>(sum);
    });
    return 0;
}

extern "C" std::size_t LLVMFuzzerCustomMutator(std::uint8_t* data, std::size_t size, std::size_t most,
                                               unsigned seed) {
    return palpate::fuzz::mutated_hdf5({data, most}, size, seed);
}
