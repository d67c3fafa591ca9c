// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace palpate::asset {

/// A file's bytes, read-only in memory for as long as a copy of this value lives. The file must not be
/// shortened meanwhile; replacing it by renaming another over it is safe.
class MappedFile {
  public:
    /// Maps the file and touches every page; throws InvalidInput if it cannot be opened or is empty.
    explicit MappedFile(const std::filesystem::path& path);

    std::span<const std::byte> bytes() const { return {start_.get(), size_}; }
    const std::shared_ptr<const std::byte>& owner() const { return start_; }

  private:
    std::shared_ptr<const std::byte> start_;
    std::size_t size_ = 0;
};

}  // namespace palpate::asset
