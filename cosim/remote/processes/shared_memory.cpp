#include "cosim/remote/processes/shared_memory.h"

#include "base/error.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/mman.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace puckloop::cosim {

SharedMemory::SharedMemory(const char* name, std::size_t size)
    : descriptor_(memfd_create(name, MFD_CLOEXEC | MFD_ALLOW_SEALING)) {
    if (descriptor_ < 0)
        throw RunError(fmt::format("no shared memory: {}{}", std::strerror(errno),
                                   errno == EMFILE ? " (ulimit -n 4096 raises the limit)" : ""));
    if (ftruncate(descriptor_, static_cast<off_t>(size)) != 0 ||
        fcntl(descriptor_, F_ADD_SEALS, F_SEAL_SHRINK | F_SEAL_GROW | F_SEAL_SEAL) != 0) {
        const int error = errno;
        close_descriptor();
        throw RunError(fmt::format("no shared memory of {} bytes: {}", size, std::strerror(error)));
    }
    map(size);
}

SharedMemory::SharedMemory(int descriptor, std::size_t size) : descriptor_(descriptor) {
    struct stat info {};
    if (fstat(descriptor, &info) != 0 || info.st_size < static_cast<off_t>(size))
        throw RunError("there is no memory to share with the conductor");
    map(size);
    madvise(data_, size_, MADV_DONTFORK);
    close_descriptor();
}

SharedMemory::~SharedMemory() {
    if (data_ != nullptr) munmap(data_, size_);
    close_descriptor();
}

void SharedMemory::close_descriptor() {
    if (descriptor_ >= 0) close(descriptor_);
    descriptor_ = -1;
}

void SharedMemory::map(std::size_t size) {
    void* const memory = mmap(nullptr, size, PROT_READ | PROT_WRITE, MAP_SHARED, descriptor_, 0);
    if (memory == MAP_FAILED) {
        const int error = errno;
        close_descriptor();
        throw RunError(fmt::format("cannot map shared memory: {}", std::strerror(error)));
    }
    data_ = static_cast<std::byte*>(memory);
    size_ = size;
}

}  // namespace puckloop::cosim
