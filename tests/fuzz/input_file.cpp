#include "tests/fuzz/target.h"

#include <sys/mman.h>
#include <unistd.h>

namespace puckloop::fuzz {

InputFile::InputFile(Input input) : descriptor_(::memfd_create("input", MFD_CLOEXEC)) {
    require(descriptor_ >= 0 &&
                ::write(descriptor_, input.data(), input.size()) == static_cast<ssize_t>(input.size()),
            "memory for an input file");
    path_ = "/proc/self/fd/" + std::to_string(descriptor_);
}

InputFile::~InputFile() {
    ::close(descriptor_);
}

}  // namespace puckloop::fuzz
