#include "tools/cli/command.h"

#include "tools/cli/time_check.h"

#include <CLI/CLI.hpp>

#include <cstdint>
#include <deque>
#include <filesystem>
#include <optional>
#include <utility>
#include <vector>

namespace puckloop::tools {

struct Command::Parts {
    std::deque<Option> options;  // addresses stay
    std::deque<Command> subcommands;
};

Option* Option::required() {
    option_->required();
    return this;
}

Option* Option::check(const Check& check) {
    if (check.shown == kTimeShown)
        option_->transform(CLI::Validator(
            [wrong = check.wrong](std::string& text) {
                std::string problem = wrong(text);
                if (problem.empty()) text = seconds_text(text);
                return problem;
            },
            ""));
    else
        option_->check(
            CLI::Validator([wrong = check.wrong](std::string& text) { return wrong(text); }, check.shown));
    return this;
}

Option* Option::excludes(Option* other) {
    option_->excludes(other->option_);
    return this;
}

Option* Option::type_name(const std::string& name) {
    option_->type_name(name);
    return this;
}

Option* Option::capture_default_str() {
    option_->capture_default_str();
    return this;
}

Option* Option::allow_extra_args(bool allowed) {
    option_->allow_extra_args(allowed);
    return this;
}

Option* Option::delimiter(char character) {
    option_->delimiter(character);
    return this;
}

Option* Option::group(const std::string& heading) {
    option_->group(heading);
    return this;
}

Command::Command(CLI::App& app) : app_(app), parts_(std::make_unique<Parts>()) {}
Command::~Command() = default;

Command* Command::add_subcommand(const std::string& name, const std::string& help) {
    return &parts_->subcommands.emplace_back(*app_.add_subcommand(name, help));
}

template <typename Value>
Option* Command::add_option(const std::string& names, Value& value, const std::string& help) {
    return keep(app_.add_option(names, value, help));
}

Option* Command::add_flag(const std::string& names, bool& value, const std::string& help) {
    return keep(app_.add_flag(names, value, help));
}

Option* Command::keep(CLI::Option* option) {
    return &parts_->options.emplace_back(option);
}

Command* Command::callback(std::function<void()> act) {
    app_.callback(std::move(act));
    return this;
}

Command* Command::require_subcommand(std::size_t least) {
    app_.require_subcommand(static_cast<int>(least));
    return this;
}

Command* Command::require_subcommand(std::size_t least, std::size_t most) {
    app_.require_subcommand(least, most);
    return this;
}

Command* Command::group(const std::string& heading) {
    app_.group(heading);
    return this;
}

Command* Command::footer(const std::string& text) {
    app_.footer(text);
    return this;
}

bool Command::subcommand_given() const {
    return !app_.get_subcommands().empty();
}

std::size_t Command::count(const std::string& option) const {
    return app_.count(option);
}

std::vector<std::string> Command::given() const {
    std::vector<std::string> names;
    for (const CLI::Option* option : app_.get_options()) {
        if (option->count() == 0) continue;
        const auto& longs = option->get_lnames();
        names.push_back(longs.empty() ? option->get_name() : "--" + longs.front());
    }
    return names;
}

template Option* Command::add_option(const std::string&, std::string&, const std::string&);
template Option* Command::add_option(const std::string&, std::filesystem::path&, const std::string&);
template Option* Command::add_option(const std::string&, double&, const std::string&);
template Option* Command::add_option(const std::string&, int&, const std::string&);
template Option* Command::add_option(const std::string&, unsigned&, const std::string&);
template Option* Command::add_option(const std::string&, std::uint64_t&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<int>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<double>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::string>&, const std::string&);
template Option* Command::add_option(const std::string&, std::optional<std::uint64_t>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::string>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<double>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<int>&, const std::string&);
template Option* Command::add_option(const std::string&, std::vector<std::uint64_t>&, const std::string&);

}  // namespace puckloop::tools
