#include "base/text_file.h"

#include "base/error.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <system_error>

namespace puckloop {

void write_file(const std::filesystem::path& file, std::string_view text) {
    errno = 0;
    std::ofstream stream(file, std::ios::binary);
    stream << text;
    stream.close();
    if (!stream)
        throw RunError(
            fmt::format("{}: cannot be written: {}", file.string(), std::strerror(errno != 0 ? errno : EIO)));
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) throw RunError(fmt::format("{}: cannot be made: {}", folder.string(), failed.message()));
}

}  // namespace puckloop
