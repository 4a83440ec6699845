#include "run/report/reserved_file.h"

#include "base/error.h"

#include <fmt/format.h>

#include <fcntl.h>
#include <sys/statvfs.h>
#include <unistd.h>

#include <algorithm>
#include <cerrno>
#include <cstring>

namespace puckloop::tools {

namespace {
constexpr mode_t kMode = 0666;
constexpr std::size_t kShareOfDisk = 4;
}  // namespace

ReservedFile::ReservedFile(std::filesystem::path path, std::size_t bytes)
    : path_(std::move(path)), part_(path_.string() + ".part") {
    descriptor_ = ::open(part_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC | O_NOFOLLOW, kMode);
    if (descriptor_ < 0) fail();
    // Less than asked is no error: then write() names it, if it matters. A small disk has other files to
    // take.
    if (::posix_fallocate(descriptor_, 0, static_cast<off_t>(bytes)) == 0) return;
    struct statvfs disk {};
    if (::fstatvfs(descriptor_, &disk) != 0) return;
    const std::size_t share = std::min(bytes, disk.f_bavail * disk.f_frsize / kShareOfDisk);
    if (share > 0) ::posix_fallocate(descriptor_, 0, static_cast<off_t>(share));
}

ReservedFile::~ReservedFile() {
    if (descriptor_ < 0) return;
    ::close(descriptor_);
    ::unlink(part_.c_str());
}

void ReservedFile::fail() const {
    throw RunError(fmt::format("{}: cannot be written: {}", path_.string(), std::strerror(errno)));
}

void ReservedFile::write(std::string_view text) {
    const std::size_t size = text.size();
    while (!text.empty()) {
        const ssize_t written = ::write(descriptor_, text.data(), text.size());
        if (written < 0 && errno == EINTR) continue;
        if (written < 0) fail();
        text.remove_prefix(static_cast<std::size_t>(written));
    }
    if (::ftruncate(descriptor_, static_cast<off_t>(size)) != 0) fail();
    if (::rename(part_.c_str(), path_.c_str()) != 0) fail();
    ::close(descriptor_);
    descriptor_ = -1;
}

}  // namespace puckloop::tools
