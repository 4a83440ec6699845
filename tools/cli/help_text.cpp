#include "tools/cli/help_text.h"

#include <algorithm>

namespace puckloop::tools {

namespace {

/// Where a line of at most `room` characters of `text` ends.
std::size_t line_end(std::string_view text, std::size_t room) {
    if (text.size() <= room) return text.size();
    const std::size_t blank = text.rfind(' ', room);
    if (blank != std::string_view::npos && blank > 0) return blank;
    const std::size_t mark = text.find_last_of(",|}", room - 1);
    if (mark != std::string_view::npos) return mark + 1;
    return std::min(text.find(' '), text.size());
}

/// Each line of `text` below the one before, from `column` on; what is too long goes on below its own text,
/// or below the second column of a list ("rab2      two of them").
std::string lines_at(const std::string& text, std::size_t column) {
    std::string lines;
    for (std::size_t at = 0; at <= text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        const std::string line = text.substr(at, end - at);
        const std::size_t gap = line.find("  ");
        const std::size_t second = gap == std::string::npos ? gap : line.find_first_not_of(' ', gap);
        const std::size_t deeper = second == std::string::npos ? 0 : second;
        if (at > 0) lines += "\n" + std::string(column, ' ');
        lines += line.substr(0, deeper) + wrapped(line.substr(deeper), column + deeper, column + deeper);
        at = end + 1;
    }
    return lines;
}

std::string two_columns(const std::string& name, const std::string& text) {
    constexpr std::size_t kIndent = 2, kDeep = 6;
    std::string left = std::string(kIndent, ' ') + wrapped(name, kIndent, kDeep);
    if (text.empty()) return left + "\n";
    const bool fits = left.find('\n') == std::string::npos && left.size() < HelpText::kColumn;
    left +=
        fits ? std::string(HelpText::kColumn - left.size(), ' ') : "\n" + std::string(HelpText::kColumn, ' ');
    return left + lines_at(text, HelpText::kColumn) + "\n";
}

}  // namespace

std::string wrapped(std::string_view text, std::size_t begin, std::size_t indent) {
    const std::size_t own = std::min(text.find_first_not_of(' '), text.size());
    text.remove_prefix(own);
    std::string lines(own, ' ');
    std::size_t column = begin + own;
    while (!text.empty()) {
        const std::size_t end = line_end(text, HelpText::kWidth - std::min(column, HelpText::kWidth - 1));
        lines += text.substr(0, end);
        text.remove_prefix(end);
        while (!text.empty() && text.front() == ' ')
            text.remove_prefix(1);
        column = indent + own;
        if (!text.empty()) lines += "\n" + std::string(column, ' ');
    }
    return lines;
}

std::string HelpText::make_option(const CLI::Option* option, bool positional) const {
    return two_columns(make_option_name(option, positional) + make_option_opts(option),
                       option->get_description());
}

/// CLI11's, without what the values of a list look like inside.
std::string HelpText::make_option_opts(const CLI::Option* option) const {
    std::string text = CLI::Formatter::make_option_opts(option);
    // "UINT:0 to 16": the range says what the type would.
    for (const char* type : {" TEXT:", " UINT:", " INT:", " FLOAT:"})
        if (text.starts_with(type)) text = " " + text.substr(std::string_view(type).size());
    if (text.starts_with(" TEXT")) text.replace(1, 4, "VALUE");
    if (text.starts_with(" UINT") || text.starts_with(" FLOAT")) text.replace(1, text[1] == 'U' ? 4 : 5, "N");
    if (text.starts_with(" INT")) text.replace(1, 3, "N");
    return text;
}

std::string HelpText::make_subcommand(const CLI::App* command) const {
    return two_columns(command->get_display_name(true), command->get_description());
}

/// CLI11's, without the empty line that a hidden group leaves at the end.
std::string HelpText::make_help(const CLI::App* command, std::string name, CLI::AppFormatMode mode) const {
    std::string text = CLI::Formatter::make_help(command, std::move(name), mode);
    if (const auto at = text.find("\n\n\n"); at != std::string::npos) text.erase(at, 1);
    return text;
}

std::string HelpText::make_usage(const CLI::App* command, std::string name) const {
    std::string text = CLI::Formatter::make_usage(command, std::move(name));
    for (const auto& [theirs, ours] :
         {std::pair{"SUBCOMMANDS", "COMMAND"}, std::pair{"SUBCOMMAND", "COMMAND"}})
        if (const auto at = text.find(theirs); at != std::string::npos)
            text.replace(at, std::string_view(theirs).size(), ours);
    while (!text.empty() && text.back() == '\n')
        text.pop_back();
    return wrapped(text, 0, 9) + "\n";
}

std::string HelpText::make_description(const CLI::App* command) const {
    const std::string text = command->get_description();
    return text.empty() ? text : wrapped(text, 0, 0) + "\n";
}

std::string HelpText::make_footer(const CLI::App* command) const {
    const std::string text = command->get_footer();
    std::string lines;
    for (std::size_t at = 0; at < text.size();) {
        const std::size_t end = std::min(text.find('\n', at), text.size());
        lines += wrapped(std::string_view(text).substr(at, end - at), 0, 0) + "\n";
        at = end + 1;
    }
    return lines;
}

}  // namespace puckloop::tools
