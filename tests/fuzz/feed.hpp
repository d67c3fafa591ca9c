// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <cstdint>
#include <filesystem>
#include <functional>
#include <span>
#include <string>

namespace palpate::fuzz {

/// The memory a reader may hold at once for a file: so many bytes for each of the file's, and so many more.
struct MemoryCap {
    std::size_t factor;
    std::size_t base;
};

/// Gives a reader a file of these bytes under that name. A refusal by one of our errors
/// (formats/model/errors.hpp) is what is expected of it; another exception passes, and more memory than `cap`
/// ends the program: both are findings.
void feed(std::span<const std::uint8_t> bytes, const std::string& name, MemoryCap cap,
          const std::function<void(const std::filesystem::path&)>& read);

/// The same for a reader of a folder: it gets one of these files, named by their order.
void feed_folder(std::span<const std::span<const std::uint8_t>> files, const std::string& name, MemoryCap cap,
                 const std::function<void(const std::filesystem::path&)>& read);

}  // namespace palpate::fuzz
