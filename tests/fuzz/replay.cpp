// SPDX-License-Identifier: Apache-2.0
// Runs a fuzz target over the files of folders, where libFuzzer is not linked; options (-...) are
// libFuzzer's. Each file has ten seconds.
#include <algorithm>
#include <csignal>
#include <cstdint>
#include <cstdlib>
#include <iostream>
#include <span>
#include <string_view>
#include <unistd.h>

#include "tests/formats/scratch.hpp"

extern "C" int LLVMFuzzerTestOneInput(const std::uint8_t* data, std::size_t size);

namespace {

// Its name stands in the line before.
void give_up(int) {
    constexpr std::string_view text = "took more than 10 s\n";
    std::_Exit(write(STDOUT_FILENO, text.data(), text.size()) > 0 ? 3 : 4);
}

}  // namespace

int main(int argc, char** argv) {
    std::vector<std::filesystem::path> files;
    for (const char* folder : std::span(argv, static_cast<std::size_t>(argc)).subspan(1))
        if (folder[0] != '-')
            for (const auto& entry : std::filesystem::directory_iterator(folder)) files.push_back(entry);
    std::ranges::sort(files);
    std::signal(SIGALRM, give_up);
    for (const std::filesystem::path& file : files) {
        std::cout << file.string() << std::endl;
        const std::vector<char> bytes = palpate::sample::read_bytes(file);
        alarm(10);
        LLVMFuzzerTestOneInput(reinterpret_cast<const std::uint8_t*>(bytes.data()), bytes.size());
        alarm(0);
    }
    return files.empty() ? 1 : 0;
}
