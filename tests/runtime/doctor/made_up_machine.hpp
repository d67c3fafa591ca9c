// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <algorithm>
#include <filesystem>
#include <fstream>
#include <string>

#include "runtime/doctor/finding.hpp"
#include "runtime/doctor/machine.hpp"
#include "tests/formats/scratch.hpp"

namespace palpate::sample {

/// A machine whose files lie in a scratch folder, with a user who lacks nothing.
struct MadeUpMachine : doctor::Machine {
    MadeUpMachine() {
        root = folder / "";
        user = "ada";
        home = "/home/ada";
        root_home = "/superuser";
        host = "engine";
        cores = 8;
        fifo = {true, ""};
        fifo_limit = 99;
        locked_memory = {true, ""};
        locked_bytes_limit = unlimited;
        clock_resolution_ns = 1;
    }

    void write(const std::string& path, const std::string& text) const {
        make_room(path);
        std::ofstream(doctor::in_root(*this, path), std::ios::binary) << text;
    }
    void copy(const std::filesystem::path& file, const std::string& path) const {
        make_room(path);
        std::filesystem::copy_file(file, doctor::in_root(*this, path));
    }

  private:
    Scratch folder;
    void make_room(const std::string& path) const {
        std::filesystem::create_directories(doctor::in_root(*this, path).parent_path());
    }
};

/// The finding of an id; one with an empty id where there is none.
inline doctor::Finding find(const doctor::Findings& findings, const std::string& id) {
    const auto found = std::ranges::find(findings, id, &doctor::Finding::id);
    return found == findings.end() ? doctor::Finding{} : *found;
}

}  // namespace palpate::sample
