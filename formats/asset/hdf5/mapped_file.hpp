// SPDX-License-Identifier: Apache-2.0
#pragma once
#include <cstddef>
#include <filesystem>
#include <memory>
#include <span>

namespace palpate::asset {

/// How a file's bytes are held. Mapped, they cost no memory, but the file must not be changed or shortened
/// meanwhile; replacing it by renaming another over it is safe. Copied, they are the process's own, whatever
/// becomes of the file: what was checked is what is used.
enum class Held { mapped, copied };

/// A file's bytes, read-only in memory for as long as a copy of this value lives.
class MappedFile {
  public:
    /// Touches every page. Copies lie in huge pages where the system gives them: a large array then costs a
    /// page fault for each 2 MB and not for each 4 kB. Throws InvalidInput if the file cannot be opened or is
    /// empty, std::bad_alloc if a copy has no room.
    explicit MappedFile(const std::filesystem::path& path, Held held = Held::mapped);

    std::span<const std::byte> bytes() const { return {start_.get(), size_}; }
    const std::shared_ptr<const std::byte>& owner() const { return start_; }

  private:
    std::shared_ptr<const std::byte> start_;
    std::size_t size_ = 0;
};

}  // namespace palpate::asset
