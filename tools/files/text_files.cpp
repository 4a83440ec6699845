#include "tools/files/text_files.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <cerrno>
#include <cstdio>
#include <cstring>
#include <filesystem>
#include <memory>

namespace puckloop::tools {

namespace {

constexpr std::size_t kLargestText = 64u << 20;

struct Close {
    void operator()(std::FILE* file) const {
        if (file && file != stdin && file != stdout) std::fclose(file);
    }
};
using File = std::unique_ptr<std::FILE, Close>;

}  // namespace

std::string read_text(const std::string& path) {
    std::error_code ignored;
    if (path != "-" && std::filesystem::is_directory(path, ignored))
        throw InputError(path, "", "is a directory", "a text file");
    const File file(path == "-" ? stdin : std::fopen(path.c_str(), "rb"));
    if (!file)
        throw InputError(path, "", std::string("cannot be read: ") + std::strerror(errno), "a text file");
    std::string text;
    char buffer[16384];
    while (const std::size_t got = std::fread(buffer, 1, sizeof buffer, file.get())) {
        text.append(buffer, got);
        if (text.size() > kLargestText) throw InputError(path, "", "is larger than 64 MB");
    }
    if (std::ferror(file.get())) throw InputError(path, "", "cannot be read");
    return text;
}

void write_text(const std::string& path, std::string_view text) {
    const File file(path == "-" ? stdout : new_file(path));
    if (!file) throw InputError(path, "", "cannot be written: " + why_not_written(errno));
    const bool written = std::fwrite(text.data(), 1, text.size(), file.get()) == text.size();
    if (!written || std::fflush(file.get()) != 0)
        throw RunError(path + ": cannot be written: " + std::strerror(errno));
}

}  // namespace puckloop::tools
