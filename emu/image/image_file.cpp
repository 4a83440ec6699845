#include "emu/image/image_file.h"

#include "base/error.h"
#include "base/sha256.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <filesystem>
#include <fstream>
#include <sstream>
#include <system_error>
#include <utility>

namespace puckloop::image {

namespace {

constexpr std::uintmax_t kLargestFile = 64u
                                        << 20;  // thirteen times the largest real image seen, with debug data

}  // namespace

std::string read_image_file(const std::string& path) {
    namespace fs = std::filesystem;
    std::error_code error;
    const fs::file_status status = fs::status(path, error);
    if (!fs::exists(status)) throw InputError(path, "", "no such file", "a HEX, ELF or COFF image");
    if (fs::is_directory(status)) throw InputError(path, "", "is a directory", "a HEX, ELF or COFF image");
    if (!fs::is_regular_file(status))
        throw InputError(path, "", "is not a regular file", "a HEX, ELF or COFF image");
    const std::uintmax_t size = fs::file_size(path, error);
    if (!error && size > kLargestFile)
        throw InputError(path, "", fmt::format("is {} bytes large", size), "an image of at most 64 MB");
    std::ifstream stream(path, std::ios::binary);
    if (!stream) throw InputError(path, "", fmt::format("cannot be opened: {}", std::strerror(errno)));
    std::ostringstream bytes;
    bytes << stream.rdbuf();  // fails where there is nothing
    if (stream.bad() || bytes.bad()) throw InputError(path, "", "cannot be read");
    return std::move(bytes).str();
}

bool looks_like_hex(std::string_view bytes) {
    const std::size_t first = bytes.find_first_not_of(" \t\r\n");
    return first != std::string_view::npos && bytes[first] == ':';
}

}  // namespace puckloop::image
