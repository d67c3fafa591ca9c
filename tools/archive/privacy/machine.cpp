// SPDX-License-Identifier: GPL-3.0-or-later
#include "tools/archive/privacy/machine.hpp"

#include <algorithm>
#include <array>
#include <cstdlib>
#include <filesystem>
#include <pwd.h>
#include <set>
#include <unistd.h>

namespace palpate::archive {
namespace {

// Names that tell nobody, or that stand in any text.
const std::set<std::string>& everybodys() {
    static const std::set<std::string> names{"root",      "user",   "nobody", "admin", "debian", "ubuntu",
                                             "localhost", "runner", "docker", "guest", "test",   "build",
                                             "vm",        "host",   "node",   "main",  "linux"};
    return names;
}

void add(std::vector<std::string>& names, const char* name) {
    if (name == nullptr) return;
    const std::string found(name);
    if (found.size() >= 3 && !everybodys().contains(found) && std::ranges::find(names, found) == names.end())
        names.push_back(found);
}

}  // namespace

Machine this_machine() {
    Machine machine;
    if (const passwd* entry = getpwuid(geteuid())) add(machine.users, entry->pw_name);
    for (const char* variable : {"USER", "LOGNAME"}) add(machine.users, std::getenv(variable));
    std::array<char, 256> host{};
    if (gethostname(host.data(), host.size() - 1) == 0) add(machine.hosts, host.data());
    add(machine.hosts, std::getenv("HOSTNAME"));

    std::set<std::string> folders{"home", "root", "Users",  "mnt",     "media", "data",    "srv",  "tmp",
                                  "work", "nfs",  "export", "scratch", "net",   "Volumes", "gpfs", "lustre"};
    const std::set<std::string> systems{"bin", "boot", "dev", "etc",  "lib", "lib32", "lib64", "libx32",
                                        "opt", "proc", "run", "sbin", "sys", "usr",   "var"};
    std::error_code error;
    for (std::filesystem::directory_iterator entry("/", error), end; !error && entry != end;
         entry.increment(error))
        if (const std::string name = entry->path().filename().string();
            entry->is_directory(error) && name.size() >= 3 && !systems.contains(name))
            folders.insert(name);
    machine.folders.assign(folders.begin(), folders.end());
    return machine;
}

}  // namespace palpate::archive
