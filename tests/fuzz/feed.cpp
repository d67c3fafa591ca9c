// SPDX-License-Identifier: Apache-2.0
#include "tests/fuzz/feed.hpp"

#include <cstdlib>
#include <fstream>
#include <iostream>

#include "formats/model/errors.hpp"
#include "tests/formats/scratch.hpp"
#include "tests/fuzz/allocation_gauge.hpp"

namespace palpate::fuzz {
namespace {

void write(const std::filesystem::path& path, std::span<const std::uint8_t> bytes) {
    std::ofstream(path, std::ios::binary)
        .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
}

// Has `size` bytes at `path` read within the cap.
void read_within(const std::filesystem::path& path, std::size_t size, MemoryCap cap,
                 const std::function<void(const std::filesystem::path&)>& read) {
    reset_peak_allocation();
    try {
        read(path);
    } catch (const Error&) {
    }
    const std::size_t most = cap.factor * size + cap.base;
    if (peak_allocation() <= most) return;
    std::cerr << path.filename().string() << ": took " << peak_allocation() << " bytes of memory for " << size
              << " bytes of file (expected " << most << " at most)\n";
    std::abort();
}

const sample::Scratch& scratch() {
    static const sample::Scratch folder;
    return folder;
}

}  // namespace

void feed(std::span<const std::uint8_t> bytes, const std::string& name, MemoryCap cap,
          const std::function<void(const std::filesystem::path&)>& read) {
    const std::filesystem::path path = scratch() / name;
    write(path, bytes);
    read_within(path, bytes.size(), cap, read);
}

void feed_folder(std::span<const std::span<const std::uint8_t>> files, const std::string& name, MemoryCap cap,
                 const std::function<void(const std::filesystem::path&)>& read) {
    const std::filesystem::path folder = scratch() / name;
    std::filesystem::remove_all(folder);
    std::filesystem::create_directories(folder);
    std::size_t size = 0, number = 0;
    for (const auto& bytes : files) {
        write(folder / std::to_string(++number), bytes);
        size += bytes.size();
    }
    read_within(folder, size, cap, read);
}

}  // namespace palpate::fuzz
