// SPDX-License-Identifier: Apache-2.0
#include "formats/asset/hdf5/mapped_file.hpp"

#include <cerrno>
#include <fcntl.h>
#include <string>
#include <sys/mman.h>
#include <sys/stat.h>
#include <system_error>
#include <unistd.h>

#include "formats/model/errors.hpp"

namespace palpate::asset {

MappedFile::MappedFile(const std::filesystem::path& path) {
    const int file = open(path.c_str(), O_RDONLY | O_CLOEXEC);
    struct stat status {};
    const bool opened = file >= 0 && fstat(file, &status) == 0;
    const bool regular = opened && S_ISREG(status.st_mode);
    void* start = MAP_FAILED;
    if (regular && status.st_size > 0) {
        size_ = static_cast<std::size_t>(status.st_size);
        start = mmap(nullptr, size_, PROT_READ, MAP_PRIVATE | MAP_POPULATE, file, 0);
    }
    const int error = errno;
    if (file >= 0) close(file);
    if (start == MAP_FAILED) {
        const std::string found = !opened    ? "cannot be read: " + std::generic_category().message(error)
                                  : !regular ? "is not a file"
                                  : status.st_size == 0
                                      ? "is empty"
                                      : "cannot be mapped: " + std::generic_category().message(error);
        throw InvalidInput({path.string(), found, "", "check the path and its permissions"});
    }
    start_ = std::shared_ptr<const std::byte>(
        static_cast<const std::byte*>(start),
        [size = size_](const std::byte* mapped) { munmap(const_cast<std::byte*>(mapped), size); });
}

}  // namespace palpate::asset
