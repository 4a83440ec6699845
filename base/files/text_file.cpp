#include "base/files/text_file.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstdio>
#include <fstream>
#include <iterator>
#include <system_error>

namespace puckloop {

std::optional<std::string> read_whole_file(const std::filesystem::path& file) {
    std::ifstream in(file, std::ios::binary);
    if (!in) return std::nullopt;
    return std::string{std::istreambuf_iterator<char>(in), {}};
}

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
