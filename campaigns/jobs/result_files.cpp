#include "campaigns/jobs/result_files.h"

#include "base/error.h"
#include "base/files/new_file.h"

#include <fmt/format.h>

#include <cerrno>
#include <cstring>
#include <fstream>

namespace puckloop::jobs {

namespace fs = std::filesystem;

void write_whole(const fs::path& file, const std::string& text) {
    const fs::path part = file.string() + ".part";
    {
        make_new_file(part);
        std::ofstream out(part, std::ios::binary);
        out << text;
        out.flush();
        if (!out) {
            const int reason = errno;
            std::error_code ignored;
            fs::remove(part, ignored);
            throw RunError(fmt::format("{}: cannot be written: {}", file.string(), std::strerror(reason)));
        }
    }
    fs::rename(part, file);
}

std::string csv_cell(const std::string& text) {
    if (text.find_first_of(",\"\n") == std::string::npos) return text;
    std::string quoted = "\"";
    for (const char letter : text)
        quoted += letter == '"' ? std::string("\"\"") : std::string(1, letter);
    return quoted + "\"";
}

}  // namespace puckloop::jobs
