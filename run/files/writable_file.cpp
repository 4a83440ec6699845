#include "run/files/writable_file.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdlib>
#include <cstring>
#include <string>

#include <unistd.h>

namespace puckloop::tools {

void check_writable(const std::filesystem::path& path) {
    std::error_code error;
    if (std::filesystem::is_directory(path, error))
        throw InputError(path.string(), "", "is a folder", "a file");
    if (is_refused_link(path))
        throw InputError(path.string(), "", why_not_written(ELOOP), "the file itself, or another name");
    std::string probe = path.string() + ".XXXXXX";
    const int descriptor = ::mkstemp(probe.data());
    if (descriptor < 0)
        throw InputError(path.string(), "", fmt::format("cannot be written: {}", std::strerror(errno)));
    ::close(descriptor);
    ::unlink(probe.c_str());
}

}  // namespace puckloop::tools
