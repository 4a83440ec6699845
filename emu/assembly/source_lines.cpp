#include "emu/assembly/source_lines.h"

#include "base/error.h"
#include "emu/assembly/text.h"

#include <filesystem>
#include <fstream>
#include <iterator>

namespace puckloop::assembly {

namespace {

constexpr int kDeepestInclude = 8;

/// Cuts "; ..." and "// ..." unless they stand in a quoted text or character.
std::string_view without_comment(std::string_view line) {
    bool quoted = false;
    for (std::size_t i = 0; i < line.size(); ++i) {
        if (quoted && line[i] == '\\') {
            ++i;
        } else if (line[i] == '"') {
            quoted = !quoted;
        } else if (!quoted) {
            if (line[i] == '\'' && i + 2 < line.size() && line[i + 2] == '\'')
                i += 2;
            else if (line[i] == ';' || (line[i] == '/' && i + 1 < line.size() && line[i + 1] == '/'))
                return line.substr(0, i);
        }
    }
    return line;
}

void append(std::vector<SourceLine>& lines, std::string_view source, const std::string& file, int depth) {
    int number = 0;
    std::size_t position = 0;
    while (position < source.size()) {
        const std::size_t newline = source.find('\n', position);
        const std::size_t end = newline == std::string_view::npos ? source.size() : newline;
        const std::string_view text = trim(without_comment(source.substr(position, end - position)));
        position = end + 1;
        ++number;
        constexpr std::string_view kInclude = ".include";
        if (!text.starts_with(kInclude)) {
            if (!text.empty()) lines.push_back({file, number, std::string(text)});
            continue;
        }
        const std::string place = "line " + std::to_string(number);
        const std::string_view name = trim(text.substr(kInclude.size()));
        if (name.size() < 3 || name.front() != '"' || name.back() != '"')
            throw InputError(file, place, ".include without a file name", "a name in quotes");
        if (depth >= kDeepestInclude) throw InputError(file, place, ".include nested more than 8 deep");
        const std::filesystem::path path =
            std::filesystem::path(file).parent_path() / std::string(name.substr(1, name.size() - 2));
        std::ifstream stream(path, std::ios::binary);
        if (!stream || std::filesystem::is_directory(path))
            throw InputError(file, place, "cannot read " + path.string(), "an included source file");
        const std::string content{std::istreambuf_iterator<char>(stream), std::istreambuf_iterator<char>()};
        append(lines, content, path.string(), depth + 1);
    }
}

}  // namespace

std::vector<SourceLine> read_source(std::string_view source, const std::string& file) {
    std::vector<SourceLine> lines;
    append(lines, source, file, 0);
    return lines;
}

}  // namespace puckloop::assembly
