#include "tools/run/reserved_file.h"

#include "base/error.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fcntl.h>
#include <unistd.h>

namespace puckloop::tools {

namespace {
constexpr mode_t kMode = 0666;
}

ReservedFile::ReservedFile(std::filesystem::path path, std::size_t bytes)
    : path_(std::move(path)), part_(path_.string() + ".part") {
    descriptor_ = ::open(part_.c_str(), O_RDWR | O_CREAT | O_TRUNC | O_CLOEXEC, kMode);
    if (descriptor_ < 0) fail();
    // Less than asked is no error: then write() tells, if it matters.
    ::posix_fallocate(descriptor_, 0, static_cast<off_t>(bytes));
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
