// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/feed.hpp"

#include <cstdlib>
#include <fstream>
#include <iostream>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/fuzz/allocation_gauge.hpp"

namespace palpate::fuzz {

void feed(std::span<const std::uint8_t> bytes, const std::string& name, MemoryCap cap,
          const std::function<void(const std::filesystem::path&)>& read) {
    static const sample::Scratch scratch;
    const std::filesystem::path path = scratch / name;
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    reset_peak_allocation();
    try {
        read(path);
    } catch (const Error&) {
    }
    const std::size_t most = cap.factor * bytes.size() + cap.base;
    if (peak_allocation() <= most) return;
    std::cerr << name << ": took " << peak_allocation() << " bytes of memory for a file of " << bytes.size()
              << " (expected " << most << " at most)\n";
    std::abort();
}

}  // namespace palpate::fuzz
