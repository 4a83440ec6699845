#include "linuxboard/shim/node/output_log.h"

#include "base/error.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>

namespace puckloop::linuxboard {

namespace {

constexpr off_t kLastLines = 64 * 1024;  // bytes, for messages about the program's end
constexpr off_t kPiece = 1 << 20;        // bytes that are worth a system call

off_t size_of(int descriptor) {
    struct stat status {};
    return fstat(descriptor, &status) == 0 && S_ISREG(status.st_mode) ? status.st_size : 0;
}

}  // namespace

OutputLog::OutputLog(const std::string& file) {
    if (file.empty()) return;
    descriptor_ = open(file.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_APPEND | O_CLOEXEC | O_NOFOLLOW, 0644);
    if (descriptor_ < 0) throw InputError(file, "", std::strerror(errno), "a log file that can be written");
}

OutputLog::~OutputLog() {
    if (descriptor_ < 0) return;
    const off_t size = size_of(descriptor_);
    if (size > kMost && ftruncate(descriptor_, kMost) == 0) {
        char last = '\n';
        [[maybe_unused]] const auto read = pread(descriptor_, &last, 1, kMost - 1);
        const std::string line = fmt::format("{}puckloop: the other {} bytes of the output are left out\n",
                                             last == '\n' ? "" : "\n", size - kMost);
        [[maybe_unused]] const auto written = write(descriptor_, line.data(), line.size());
    }
    close(descriptor_);
}

void OutputLog::release() {
    if (descriptor_ < 0) return;
    const off_t until = size_of(descriptor_) - kLastLines;
    if (until < released_ + kPiece) return;
    // Not every file system can; there the file is cut at the end only.
    fallocate(descriptor_, FALLOC_FL_PUNCH_HOLE | FALLOC_FL_KEEP_SIZE, released_, until - released_);
    released_ = until;
}

}  // namespace puckloop::linuxboard
