// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target over the files of folders, where libFuzzer is not linked; options (-...) are
// libFuzzer's.
#include <algorithm>
#include <cstdint>
#include <iostream>
#include <span>

#include "tests/formats/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

int main(int argc, char** argv) {
    std::vector<std::filesystem::path> files;
    for (const char* folder : std::span(argv, static_cast<std::size_t>(argc)).subspan(1))
        if (folder[0] != '-')
            for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry);
    std::ranges::sort(files);
    for (const std::filesystem::path& file : files) {
        std::cout << file.string() << std::endl;
        const std::vector<char> bytes = palpate::sample::read_bytes(file);
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
    }
    return files.empty() ? 1 : 0;
}
