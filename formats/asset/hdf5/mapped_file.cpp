// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/hdf5/mapped_file.hpp"

#include <cerrno>
#include <cstdlib>
#include <fcntl.h>
#include <new>
#include <string>
#include <sys/mman.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "formats/model/errors.hpp"

namespace palpate::asset {

namespace {

std::shared_ptr<const std::byte> mapped(int file, std::size_t size) {
    void* const start = mmap(nullptr, size, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file, 0);
    if (start == MAP_FAILED) return nullptr;
    return {static_cast<const std::byte*>(start),
            [size](const std::byte* bytes) { munmap(const_cast<std::byte*>(bytes), size); }};
}

std::shared_ptr<const std::byte> copied(int file, std::size_t size) {
    constexpr std::size_t huge_page = std::size_t{2} << 20;
    const std::size_t whole = (size + huge_page - 1) / huge_page * huge_page;
    void* const pages = std::aligned_alloc(huge_page, whole);
    if (pages == nullptr) throw std::bad_alloc();
    const std::shared_ptr<std::byte> bytes(static_cast<std::byte*>(pages), std::free);
    madvise(pages, whole, MADV_HUGEPAGE);  // advice alone: without it the pages are small
    for (std::size_t done = 0; done < size;) {
        const ssize_t some = read(file, bytes.get() + done, size - done);
        if (some < 0 && errno == EINTR) continue;
        if (some <= 0) return nullptr;
        done += static_cast<std::size_t>(some);
    }
    return bytes;
}

}  // namespace

MappedFile::MappedFile(const std::filesystem::path& path, Held held) {
    const int file =
        open(path.c_str(), O_RDONLY | O_CLOEXEC | O_NONBLOCK);  // a pipe without a writer is told, too
    struct stat status {};
    const bool opened = file >= 0 && fstat(file, &status) == 0;
    const bool regular = opened && S_ISREG(status.st_mode);
    if (regular && status.st_size > 0) {
        size_ = static_cast<std::size_t>(status.st_size);
        start_ = held == Held::mapped ? mapped(file, size_) : copied(file, size_);
    }
    const int error = errno;
    if (file >= 0) close(file);
    if (start_) return;
    const std::string found = !opened    ? "cannot be read: " + std::generic_category().message(error)
                              : !regular ? "is not a file"
                              : status.st_size == 0
                                  ? "is empty"
                                  : "cannot be read whole: " + std::generic_category().message(error);
    throw InvalidInput({path.string(), found, "", "check the path and its permissions"});
}

}  // namespace palpate::asset
