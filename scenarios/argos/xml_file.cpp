#include "scenarios/argos/xml_file.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <cerrno>
#include <charconv>
#include <cmath>
#include <cstring>
#include <fstream>

namespace puckloop::argos {

namespace {

constexpr std::size_t kLargestFile = 16 << 20;

std::string_view trimmed(std::string_view text) {
    constexpr std::string_view kSpace = " \t\r\n";
    const auto first = text.find_first_not_of(kSpace);
    if (first == std::string_view::npos) return {};
    return text.substr(first, text.find_last_not_of(kSpace) - first + 1);
}

/// A number as ARGoS reads it: ".66", "+1", "1e-3".
bool parse(std::string_view text, double& value) {
    text = trimmed(text);
    if (text.starts_with('+')) text.remove_prefix(1);
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), value);
    constexpr double kLargest = 1e6;
    return error == std::errc{} && end == text.data() + text.size() && std::abs(value) <= kLargest;
}

std::string read_text(const std::filesystem::path& file) {
    std::error_code ignored;
    if (std::filesystem::is_directory(file, ignored))
        throw InputError(file.string(), "", "is a directory", "an ARGoS experiment file");
    errno = 0;
    std::ifstream stream(file, std::ios::binary);
    if (!stream)
        throw InputError(file.string(), "",
                         fmt::format("cannot be opened: {}", std::strerror(errno != 0 ? errno : EIO)),
                         "an ARGoS experiment file");
    std::string text(kLargestFile + 1, '\0');
    stream.read(text.data(), static_cast<std::streamsize>(text.size()));
    text.resize(static_cast<std::size_t>(stream.gcount()));
    if (text.size() > kLargestFile)
        throw InputError(file.string(), "", "is too large", "at most 16 MB of XML");
    return text;
}

}  // namespace

XmlFile::XmlFile(const std::filesystem::path& file) : name_(file.string()) {
    const std::string text = read_text(file);
    for (std::size_t at = text.find('\n'); at != std::string::npos; at = text.find('\n', at + 1))
        line_ends_.push_back(at);
    const pugi::xml_parse_result result =
        document_.load_buffer(text.data(), text.size(), pugi::parse_default, pugi::encoding_utf8);
    if (!result) {
        const auto offset = static_cast<std::size_t>(std::max<std::ptrdiff_t>(result.offset, 0));
        const auto line =
            std::lower_bound(line_ends_.begin(), line_ends_.end(), offset) - line_ends_.begin() + 1;
        throw InputError(name_, fmt::format("line {}", line),
                         fmt::format("malformed XML: {}", result.description()), "well-formed XML");
    }
    if (!root()) throw InputError(name_, "line 1", "there is no element", "<argos-configuration>");
}

int XmlFile::line_of(pugi::xml_node node) const {
    const std::ptrdiff_t offset = node.offset_debug();
    if (offset < 0) return 1;
    return static_cast<int>(
               std::lower_bound(line_ends_.begin(), line_ends_.end(), static_cast<std::size_t>(offset)) -
               line_ends_.begin()) +
           1;
}

void XmlFile::fail(pugi::xml_node node, const std::string& problem, std::string_view expected) const {
    throw InputError(name_, fmt::format("line {}", line_of(node)), problem, expected);
}

std::string XmlFile::text(pugi::xml_node node, const char* attribute) const {
    const pugi::xml_attribute found = node.attribute(attribute);
    if (!found) fail(node, fmt::format("{} has no attribute '{}'", described(node), attribute));
    std::string value(trimmed(found.value()));
    for (char& c : value)  // a line end can be written as a character reference
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
    return value;
}

std::string XmlFile::text(pugi::xml_node node, const char* attribute, std::string_view fallback) const {
    return node.attribute(attribute) ? text(node, attribute) : std::string(fallback);
}

double XmlFile::number(pugi::xml_node node, const char* attribute, std::optional<double> fallback) const {
    if (fallback && !node.attribute(attribute)) return *fallback;
    const std::string value = text(node, attribute);
    double number = 0.0;
    if (!parse(value, number))
        fail(node, fmt::format("{}: {} = '{}' is no number", described(node), attribute, value),
             "a number of at most 1e6");
    return number;
}

long long XmlFile::integer(pugi::xml_node node, const char* attribute, long long low, long long high,
                           std::optional<long long> fallback) const {
    if (fallback && !node.attribute(attribute)) return *fallback;
    const std::string value = text(node, attribute);
    long long number = 0;
    const auto [end, error] = std::from_chars(value.data(), value.data() + value.size(), number);
    if (error != std::errc{} || end != value.data() + value.size() || number < low || number > high)
        fail(node, fmt::format("{}: {} = '{}' is out of range", described(node), attribute, value),
             fmt::format("a whole number from {} to {}", low, high));
    return number;
}

bool XmlFile::flag(pugi::xml_node node, const char* attribute, bool fallback) const {
    if (!node.attribute(attribute)) return fallback;
    const std::string value = text(node, attribute);
    if (value == "true" || value == "1") return true;
    if (value != "false" && value != "0")
        fail(node, fmt::format("{}: {} = '{}' is neither true nor false", described(node), attribute, value),
             "true or false");
    return false;
}

std::vector<double> XmlFile::numbers(pugi::xml_node node, const char* attribute, std::size_t count,
                                     std::optional<std::vector<double>> fallback) const {
    if (fallback && !node.attribute(attribute)) return *fallback;
    const std::string value = text(node, attribute);
    std::vector<double> result;
    for (std::string_view rest = value;;) {
        const auto comma = rest.find(',');
        double number = 0.0;
        if (!parse(rest.substr(0, comma), number)) break;
        result.push_back(number);
        if (comma == std::string_view::npos) {
            if (result.size() == count) return result;
            break;
        }
        rest.remove_prefix(comma + 1);
    }
    fail(node, fmt::format("{}: {} = '{}'", described(node), attribute, value),
         fmt::format("{} numbers of at most 1e6, separated by commas", count));
}

void XmlFile::note(pugi::xml_node node, const std::string& text) {
    const int line = line_of(node);
    const auto same = [&](const Note& other) { return other.line == line && other.text == text; };
    if (std::none_of(notes_.begin(), notes_.end(), same)) notes_.push_back({line, text});
}

std::string described(pugi::xml_node node) {
    std::string id = node.attribute("id").value();
    for (char& c : id)
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F) c = ' ';
    return id.empty() ? fmt::format("<{}>", node.name()) : fmt::format("<{}> '{}'", node.name(), id);
}

}  // namespace puckloop::argos
