#pragma once
// What --help looks like: 100 columns, two of them, commands and options in groups.

#include <CLI/CLI.hpp>

#include <cstddef>
#include <string>
#include <string_view>

namespace puckloop::tools {

/// `text`, which begins in column `begin`, in lines of at most HelpText::kWidth characters, broken at blanks;
/// the lines behind the first begin with `indent` blanks, and with as many more as the text itself begins
/// with. A word longer than a line is broken after a comma, a bar or a brace, else not at all.
std::string wrapped(std::string_view text, std::size_t begin, std::size_t indent);

class HelpText final : public CLI::Formatter {
  public:
    static constexpr std::size_t kWidth = 100, kColumn = 30;

    std::string make_option(const CLI::Option* option, bool positional) const override;
    std::string make_option_opts(const CLI::Option* option) const override;
    std::string make_subcommand(const CLI::App* command) const override;
    std::string make_help(const CLI::App* command, std::string name, CLI::AppFormatMode mode) const override;
    std::string make_usage(const CLI::App* command, std::string name) const override;
    std::string make_description(const CLI::App* command) const override;
    std::string make_footer(const CLI::App* command) const override;
};

}  // namespace puckloop::tools
