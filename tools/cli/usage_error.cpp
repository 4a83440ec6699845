#include "tools/cli/usage_error.h"

#include "base/plain_text.h"
#include "base/text/suggest.h"
#include "tools/cli/shown_word.h"

#include <CLI/CLI.hpp>
#include <fmt/format.h>

#include <string_view>
#include <vector>

namespace puckloop::tools {

namespace {

// Bytes that are shown of what the library states of a word: its lists are shorter.
constexpr std::size_t kProblem = 1000;

/// The subcommand that the words reached, or the program itself.
const CLI::App& command_of(const CLI::App& app) {
    const CLI::App* command = &app;
    while (!command->get_subcommands().empty())
        command = command->get_subcommands().front();
    return *command;
}

/// The words that reach it: "bench rab".
std::string path_of(const CLI::App& app, const CLI::App& command) {
    std::string path = command.get_name();
    for (const CLI::App* above = command.get_parent(); above && above != &app; above = above->get_parent())
        path = above->get_name() + " " + path;
    return path;
}

std::string nearest_option(const CLI::App& command, const std::string& word) {
    std::vector<std::string> names;
    const bool option = word.starts_with("--");
    if (option) {
        for (const CLI::Option* known : command.get_options())
            for (const std::string& name : known->get_lnames())
                names.push_back(name);
    } else {
        for (const CLI::App* known : command.get_subcommands({}))
            if (!known->get_group().empty()) names.push_back(known->get_name());
    }
    const std::string bare = option ? word.substr(2, word.find('=') - 2) : word;
    const std::string meant = nearest_name(bare, {names.begin(), names.end()});
    return option && !meant.empty() ? "--" + meant : meant;
}

/// A part that is near to a word taken as the command's own argument: `gap chek DIR`.
std::string misspelt_part(const CLI::App& command) {
    for (const CLI::Option* option : command.get_options())
        for (const std::string& word :
             option->get_positional() ? option->results() : std::vector<std::string>{})
            if (const std::string meant = nearest_option(command, word); !meant.empty()) return meant;
    return {};
}

/// "decode, export and rab": what can stand in a command's first place.
std::string parts_of(const CLI::App& command) {
    std::vector<std::string> names;
    for (const CLI::App* part : command.get_subcommands([](const CLI::App*) { return true; }))
        if (!part->get_name().empty()) names.push_back(part->get_name());
    return fmt::format("{}", fmt::join(names, ", "));
}

/// The word that nobody asked for: an option before the values that may belong to it.
std::string unexpected_word(const CLI::App& app) {
    const std::vector<std::string> words = app.remaining(true);
    for (const std::string& word : words)
        if (word.starts_with("-")) return word;
    return words.empty() ? std::string() : words.front();
}

}  // namespace

std::string usage_error(const CLI::App& app, const CLI::ParseError& error) {
    const CLI::App& command = command_of(app);
    const bool in_command = &command != &app;
    const std::string name = in_command ? path_of(app, command) : std::string();
    std::string help = fmt::format("see puckloop {}--help", in_command ? name + " " : "");
    std::string problem = error.what();
    if (const auto end = problem.find('\n'); end != std::string::npos) problem.resize(end);
    problem = plain_text(problem, kProblem);
    const std::string word = unexpected_word(app);
    const int code = error.get_exit_code();
    const bool no_command = !in_command && code == static_cast<int>(CLI::ExitCodes::RequiredError);
    if (!word.empty() && (no_command || code == static_cast<int>(CLI::ExitCodes::ExtrasError))) {
        const char* kind = word.starts_with("-") ? "option" : in_command ? "argument" : "command";
        problem = fmt::format("unknown {} '{}'", kind, shown_word(word));
        const std::string parts = in_command ? parts_of(command) : std::string();
        if (const std::string part = misspelt_part(command); !word.starts_with("-") && !part.empty())
            help = fmt::format("perhaps {} {}; {}", name, part, help);
        else if (!word.starts_with("-") && !parts.empty())
            help = fmt::format("its parts are {}; {}", parts, help);
        else if (const std::string meant = nearest_option(command, word); !meant.empty())
            help = fmt::format("perhaps {}; {}", meant, help);
    } else if (no_command) {
        problem = "no command given";
    }
    return fmt::format("{}{} ({})", in_command ? name + ": " : "", problem, help);
}

}  // namespace puckloop::tools
