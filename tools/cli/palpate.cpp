// SPDX-License-Identifier: Apache-2.0
// `palpate <command> ...` runs `palpate-<command> ...` from the same folder.
#include <algorithm>
#include <cstdlib>
#include <filesystem>
#include <iostream>
#include <string>
#include <unistd.h>
#include <vector>

#include "formats/model/label_map.hpp"
#include "tools/cli/command.hpp"
#include "tools/cli/software.hpp"

namespace {

std::vector<std::string> installed_commands() {
    std::vector<std::string> names;
    for (const auto& entry : std::filesystem::directory_iterator(palpate::cli::programs_folder())) {
        const std::string name = entry.path().filename().string();
        if (name.starts_with("palpate-")) names.push_back(name.substr(8));
    }
    std::ranges::sort(names);
    return names;
}

void print_usage(std::ostream& stream) {
    stream << "palpate " << palpate::cli::version()
           << ": turns a patient's CT or MRI into an organ that a hand can feel\n\n"
              "Usage: palpate <command> [options]\n       palpate <command> --help\n\nCommands:\n";
    for (const std::string& name : installed_commands()) stream << "  " << name << '\n';
}

int flushed() try {
    palpate::cli::flush_stdout();
    return palpate::cli::ExitCode::ok;
} catch (const palpate::Error& error) {
    std::cerr << "palpate: " << error.what() << '\n';
    return palpate::cli::ExitCode::failed;
}

}  // namespace

int main(int argc, char** argv) {
    if (argc < 2) {
        print_usage(std::cerr);
        return palpate::cli::ExitCode::usage;
    }
    const std::string name = argv[1];
    if (name == "--help" || name == "-h" || name == "help") {
        print_usage(std::cout);
        return flushed();
    }
    if (name == "--version") {
        std::cout << "palpate " << palpate::cli::version() << '\n';
        return flushed();
    }
    const std::filesystem::path program = palpate::cli::programs_folder() / ("palpate-" + name);
    if (name.starts_with("-") || name.find('/') != std::string::npos || !std::filesystem::exists(program)) {
        std::cerr << "palpate: no command '" << name << "'";
        const auto near = palpate::nearest_names(name, installed_commands());
        for (std::size_t i = 0; i < near.size(); ++i) std::cerr << (i == 0 ? "; nearest: " : ", ") << near[i];
        std::cerr << '\n';
        return palpate::cli::ExitCode::usage;
    }
    // Large arrays in huge pages also where the system gives them on request alone: a large case then opens
    // in half the time. glibc reads this when a program begins, and no later.
    // NOLINTNEXTLINE(concurrency-mt-unsafe): before there is a second thread
    setenv("GLIBC_TUNABLES", "glibc.malloc.hugetlb=1", 0);
    execv(program.c_str(), argv + 1);
    std::perror(program.c_str());
    return palpate::cli::ExitCode::failed;
}
