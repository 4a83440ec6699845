#include "linuxboard/shim/node/last_line.h"

namespace puckloop::linuxboard {

namespace {

constexpr char kEscape = '\x1b', kBell = '\a', kDeleteCharacter = '\x7f';

bool within(char c, char low, char high) {
    return c >= low && c <= high;
}

/// First character behind the escape sequence (ECMA-48) that begins at `at`.
std::size_t behind_escape(std::string_view text, std::size_t at) {
    if (++at == text.size()) return at;
    const char kind = text[at++];
    if (kind == '[') {  // parameters, intermediates, one final character
        while (at < text.size() && within(text[at], ' ', '?'))
            ++at;
        return at < text.size() ? at + 1 : at;
    }
    if (kind == ']') {  // a title, say: up to BEL or ESC backslash
        while (at < text.size() && text[at] != kBell && text[at] != kEscape)
            ++at;
        if (at < text.size() && text[at] == kEscape) ++at;
        return at < text.size() ? at + 1 : at;
    }
    if (within(kind, ' ', '/'))  // a character set, say
        while (at < text.size() && within(text[at - 1], ' ', '/'))
            ++at;
    return at;
}

std::string text_of(std::string_view line) {
    std::string text;
    for (std::size_t at = 0; at < line.size();) {
        if (line[at] == kEscape) {
            at = behind_escape(line, at);
            continue;
        }
        const char c = line[at++];
        if (static_cast<unsigned char>(c) >= ' ' && c != kDeleteCharacter)
            text += c;
        else if (c == '\t')
            text += ' ';
    }
    const auto first = text.find_first_not_of(' ');
    if (first == std::string::npos) return {};
    return text.substr(first, text.find_last_not_of(' ') - first + 1);
}

}  // namespace

std::string last_line_with_text(std::string_view output) {
    while (!output.empty()) {
        const auto end = output.find_last_of("\r\n");
        const std::string text = text_of(end == std::string_view::npos ? output : output.substr(end + 1));
        if (!text.empty() || end == std::string_view::npos) return text;
        output = output.substr(0, end);
    }
    return {};
}

}  // namespace puckloop::linuxboard
