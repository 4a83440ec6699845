#include "base/text/toml_file.h"

#include "base/error.h"

#include <fmt/format.h>
#include <toml.hpp>

#include <cerrno>
#include <cstring>
#include <fstream>
#include <map>
#include <sstream>

namespace puckloop {

namespace {

constexpr std::size_t kLargestFile = 4 << 20;

using Parsed = toml::basic_value<toml::discard_comments, std::map, std::vector>;

int line_of(const Parsed& value) {
    return static_cast<int>(value.location().line());
}

TomlValue convert(const Parsed& value, const std::string& file) {
    TomlValue result;
    result.line = line_of(value);
    switch (value.type()) {
    case toml::value_t::boolean:
        result.data = value.as_boolean();
        break;
    case toml::value_t::integer:
        result.data = static_cast<std::int64_t>(value.as_integer());
        break;
    case toml::value_t::floating:
        result.data = value.as_floating();
        break;
    case toml::value_t::string:
        result.data = value.as_string().str;
        break;
    case toml::value_t::array: {
        TomlArray array;
        for (const Parsed& item : value.as_array())
            array.push_back(convert(item, file));
        result.data = std::move(array);
        break;
    }
    case toml::value_t::table: {
        TomlTable table;
        for (const auto& [key, item] : value.as_table())
            table.emplace_back(key, convert(item, file));
        result.data = std::move(table);
        break;
    }
    default:
        throw InputError(file, fmt::format("line {}", result.line), "dates and times have no use here",
                         "a number, a string, a list or a table");
    }
    return result;
}

/// The first line of toml11's explanation, without its own file and colour decorations.
std::string reason_of(const std::exception& error) {
    std::string text = error.what();
    if (const auto end = text.find('\n'); end != std::string::npos) text.resize(end);
    if (text.starts_with("[error] ")) text.erase(0, 8);
    if (text.starts_with("toml::")) text.erase(0, 6);
    // "parse_key_value_pair: missing ...": the parser's function is of no use to the reader.
    for (const char* function : {"parse_", "insert_"})
        if (const auto colon = text.find(": "); text.starts_with(function) && colon != std::string::npos)
            text.erase(0, colon + 2);
    return text;
}

/// What to write in the place of what the parser refuses for this reason.
const char* remedy_for(const std::string& reason) {
    for (const char* twice : {"already exists", "cannot be defined", "collides with", "is neither table nor"})
        if (reason.find(twice) != std::string::npos)
            return "each key and each table once; [[...]] for every table of a list";
    return "valid TOML: key = value, texts in quotes, numbers with a decimal point";
}

/// Deeper than this the parser would run out of stack.
constexpr int kDeepest = 100;

/// The line on which brackets are open too deep, 0 if nowhere; texts and comments do not count.
int too_deep_at(const std::string& text) {
    int depth = 0, line = 1;
    char quote = 0;
    for (std::size_t i = 0; i < text.size(); ++i) {
        const char c = text[i];
        if (c == '\n') ++line;
        if (c == '\n' && quote != 0) quote = 0;  // a text that was not closed: the parser's business
        if (quote != 0) {
            if (c == '\\' && quote == '"') ++i;
            if (c == quote) quote = 0;
        } else if (c == '"' || c == '\'') {
            quote = c;
        } else if (c == '#') {
            while (i + 1 < text.size() && text[i + 1] != '\n')
                ++i;
        } else if (c == '[' || c == '{') {
            if (++depth > kDeepest) return line;
        } else if (c == ']' || c == '}') {
            --depth;
        }
    }
    return 0;
}

}  // namespace

TomlValue read_toml(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw InputError(file.string(), "", "is a directory", "a TOML file");
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        throw InputError(file.string(), "",
                         fmt::format("cannot be opened: {}", std::strerror(errno != 0 ? errno : EIO)),
                         "a TOML file");
    std::string text(kLargestFile + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kLargestFile)
        throw InputError(file.string(), "", "is too large", "at most 4 MB of TOML");
    if (const int line = too_deep_at(text); line > 0)
        throw InputError(file.string(), fmt::format("line {}", line), "is nested too deeply",
                         fmt::format("at most {} brackets open at once", kDeepest));
    std::istringstream content(text);
    try {
        return convert(toml::parse<toml::discard_comments, std::map, std::vector>(content, file.string()),
                       file.string());
    } catch (const toml::exception& error) {
        const std::string reason = reason_of(error);
        throw InputError(
            file.string(),
            fmt::format("line {}, column {}", error.location().line(), error.location().column()), reason,
            remedy_for(reason));
    } catch (const InputError&) {
        throw;
    } catch (const std::exception& error) {
        throw InputError(file.string(), "", reason_of(error), "valid TOML");
    }
}

}  // namespace puckloop
