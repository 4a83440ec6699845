#include "base/text_file.h"

#include "base/error.h"
#include "base/new_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <system_error>

namespace puckloop {

void write_file(const std::filesystem::path& file, std::string_view text) {
    errno = 0;
    std::FILE* const stream = new_file(file);
    const bool written = stream != nullptr && std::fwrite(text.data(), 1, text.size(), stream) == text.size();
    const int reason = errno;
    const bool closed = stream != nullptr && std::fclose(stream) == 0;
    if (!written || !closed)
        throw RunError(fmt::format("{}: cannot be written: {}", file.string(),
                                   why_not_written(written ? errno : reason)));
}

void make_folder(const std::filesystem::path& folder) {
    std::error_code failed;
    std::filesystem::create_directories(folder, failed);
    if (failed) throw RunError(fmt::format("{}: cannot be made: {}", folder.string(), failed.message()));
}

}  // namespace puckloop
