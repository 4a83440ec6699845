#pragma once
// How a subcommand declares its options: CLI11 behind two plain classes. Whoever includes CLI11's header
// compiles five seconds of it; only this folder does.

#include "tools/cli/check.h"

#include <cstddef>
#include <functional>
#include <memory>
#include <string>
#include <vector>

namespace CLI {
class App;
class Option;
}  // namespace CLI

namespace puckloop::tools {

/// One option or positional argument; each call returns the option itself.
class Option {
  public:
    explicit Option(CLI::Option* option) : option_(option) {}
    Option* required();
    Option* check(const Check& check);
    Option* excludes(Option* other);
    Option* type_name(const std::string& name);  ///< shown in the help behind the option
    Option* capture_default_str();               ///< the help shows the value it has now
    Option*
    allow_extra_args(bool allowed = true);      ///< of a list: false takes one value each time it is given
    Option* delimiter(char character);          ///< of a list: several values in one word
    Option* group(const std::string& heading);  ///< "" hides it from the help

  private:
    CLI::Option* option_;
};

/// A subcommand. Options write into variables that outlive the parse; names are CLI11's ("-o,--output",
/// "!--off").
class Command {
  public:
    explicit Command(CLI::App& app);
    ~Command();
    Command(const Command&) = delete;
    Command& operator=(const Command&) = delete;

    Command* add_subcommand(const std::string& name, const std::string& help);

    /// `Value` is one of the types listed at the end of command.cpp.
    template <typename Value>
    Option* add_option(const std::string& names, Value& value, const std::string& help = {});
    Option* add_flag(const std::string& names, bool& value, const std::string& help = {});

    /// What to do when the words named this command; it may throw InputError and RunError.
    Command* callback(std::function<void()> act);
    Command* require_subcommand(std::size_t least = 1);
    Command* require_subcommand(std::size_t least, std::size_t most);
    Command* group(const std::string& heading);  ///< "" hides it from the help
    Command* footer(const std::string& text);    ///< behind the options in its own help

    bool subcommand_given() const;
    std::size_t count(const std::string& option) const;  ///< how often it was given
    /// The options that were given, by their long names; a positional argument by its name.
    std::vector<std::string> given() const;

  private:
    struct Parts;
    Option* keep(CLI::Option* option);

    CLI::App& app_;
    std::unique_ptr<Parts> parts_;
};

/// Declares a subcommand on `app` and sets a callback that returns through `status` (0 success, 1 a run or
/// check failed). Wrong use and bad input are thrown as InputError and become status 2 in run_program(). Each
/// subcommand lives in a file of its own and is listed once, in tools/commands.h.
using DeclareCommand = void (*)(Command& app, int& status);

}  // namespace puckloop::tools
