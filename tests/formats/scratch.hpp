// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <fstream>
#include <functional>
#include <iterator>
#include <string>
#include <unistd.h>
#include <vector>

#include "formats/model/errors.hpp"

namespace palpate::sample {

/// A folder of its own for one test, removed with its content at the end.
class Scratch {
  public:
    Scratch() {
        std::string name = std::filesystem::temp_directory_path() / "palpate-XXXXXX";
        folder_ = mkdtemp(name.data());
    }
    Scratch(const Scratch&) = delete;
    Scratch& operator=(const Scratch&) = delete;
    ~Scratch() { std::filesystem::remove_all(folder_); }

    std::filesystem::path operator/(const std::string& name) const { return folder_ / name; }
    const std::filesystem::path& path() const { return folder_; }

  private:
    std::filesystem::path folder_;
};

inline std::vector<char> read_bytes(const std::filesystem::path& path) {
    std::ifstream stream(path, std::ios::binary);
    return {std::istreambuf_iterator<char>(stream), {}};
}

inline void write_bytes(const std::filesystem::path& path, const std::vector<char>& bytes) {
    std::filesystem::remove(path);  // truncating in place would make ext4 wait for the disk
    std::ofstream(path, std::ios::binary).write(bytes.data(), static_cast<std::streamsize>(bytes.size()));
}

/// The message of the InvalidInput that `action` throws; another exception passes, none gives "".
inline std::string refusal(const std::function<void()>& action) {
    try {
        action();
        return "";
    } catch (const InvalidInput& error) {
        return error.what();
    }
}

}  // namespace palpate::sample
