#include "base/files/new_file.h"

#include "base/error.h"

#include <fmt/format.h>

#include <sys/stat.h>
#include <unistd.h>

#include <cerrno>
#include <cstring>
#include <system_error>

namespace puckloop {

namespace {

bool may_be_followed(const std::filesystem::path& link) {
    if (link.native().starts_with("/dev/")) return true;
    struct stat target {};
    return ::stat(link.c_str(), &target) == 0 && !S_ISREG(target.st_mode) && !S_ISDIR(target.st_mode);
}

}  // namespace

int open_new_file(const std::filesystem::path& file, int flags) {
    constexpr mode_t kMode = 0666;
    flags |= O_WRONLY | O_CREAT | O_CLOEXEC;
    const int descriptor = ::open(file.c_str(), flags | O_NOFOLLOW, kMode);
    if (descriptor >= 0 || errno != ELOOP) return descriptor;
    if (may_be_followed(file)) return ::open(file.c_str(), flags, kMode);
    errno = ELOOP;
    return -1;
}

std::FILE* new_file(const std::filesystem::path& file) {
    const int descriptor = open_new_file(file);
    if (descriptor < 0) return nullptr;
    std::FILE* const stream = ::fdopen(descriptor, "wb");
    if (stream == nullptr) {
        const int reason = errno;
        ::close(descriptor);
        errno = reason;
    }
    return stream;
}

void make_new_file(const std::filesystem::path& file) {
    const int descriptor = open_new_file(file);
    if (descriptor < 0)
        throw RunError(fmt::format("{}: cannot be written: {}", file.string(), why_not_written(errno)));
    ::close(descriptor);
}

bool is_refused_link(const std::filesystem::path& file) {
    std::error_code failed;
    return std::filesystem::is_symlink(std::filesystem::symlink_status(file, failed)) &&
           !may_be_followed(file);
}

std::string why_not_written(int error) {
    return error == ELOOP ? "is a link, which is not followed" : std::strerror(error != 0 ? error : EIO);
}

}  // namespace puckloop
