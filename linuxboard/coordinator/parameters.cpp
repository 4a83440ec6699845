#include "linuxboard/coordinator/parameters.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "base/text/toml_file.h"

#include <algorithm>
#include <charconv>
#include <cstdlib>
#include <filesystem>
#include <fmt/format.h>

namespace puckloop::coordinator {

namespace {

std::vector<std::string> split(std::string_view text) {
    std::vector<std::string> parts;
    for (;;) {
        const std::size_t comma = text.find(',');
        parts.emplace_back(text.substr(0, comma));
        if (comma == std::string_view::npos) return parts;
        text.remove_prefix(comma + 1);
    }
}

/// A file of that name here or, in a run of puckloop, beside the scenario.
std::string config_path(const std::string& name) {
    const char* folder = std::getenv("PUCKLOOP_SCENARIO_FOLDER");
    if (folder == nullptr || std::filesystem::exists(name)) return name;
    return (std::filesystem::path(folder) / name).string();
}

/// A number as short as it reads back.
std::string text_of(double value) {
    return fmt::format("{}", value);
}

std::string scalar(const TomlValue& value, const std::string& file) {
    if (const auto* text = std::get_if<std::string>(&value.data)) return *text;
    if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return std::to_string(*whole);
    if (const auto* real = std::get_if<double>(&value.data)) return text_of(*real);
    throw InputError(file, fmt::format("line {}", value.line), "is no single value",
                     "a number, a text, or a list of them");
}

/// The name that was probably meant, or where to look.
std::string expected_name(const std::string& name, const std::vector<std::string_view>& known) {
    const std::string nearest = nearest_name(name, known);
    return nearest.empty() ? "one of those that --help lists" : "--" + nearest;
}

}  // namespace

void Parameters::set(const std::string& name, std::vector<std::string> values, std::string file,
                     std::string place) {
    const auto known = set_.find(name);
    if (known != set_.end() && known->second.file.empty() && !file.empty()) return;
    set_[name] = {std::move(values), std::move(file), std::move(place)};
}

void Parameters::read_file(const std::string& file) {
    const TomlValue root = read_toml(file);
    for (const auto& [key, value] : std::get<TomlTable>(root.data)) {
        std::string name = key;
        std::replace(name.begin(), name.end(), '_', '-');
        const std::string place = fmt::format("line {}: {}", value.line, key);
        if (const bool* on = std::get_if<bool>(&value.data)) {
            set(name, {*on ? "true" : "false"}, file, place);
            continue;
        }
        std::vector<std::string> values;
        if (const auto* list = std::get_if<TomlArray>(&value.data)) {
            for (const TomlValue& item : *list)
                values.push_back(scalar(item, file));
            if (values.empty()) throw InputError(file, place, "is an empty list", "values");
        } else {
            values.push_back(scalar(value, file));
        }
        set(name, std::move(values), file, place);
    }
}

void Parameters::read_options(std::span<const char* const> words) {
    for (std::size_t i = 0; i < words.size(); ++i) {
        const std::string_view word = words[i];
        if (!word.starts_with("--") || word.size() < 3)
            throw InputError("", std::string(word), "is not an option", "--name value");
        const std::size_t equals = word.find('=');
        const std::string name(word.substr(2, equals == std::string_view::npos ? equals : equals - 2));
        const std::string place = "--" + name;
        if (equals != std::string_view::npos)
            set(name, split(word.substr(equals + 1)), "", place);
        else if (i + 1 < words.size() && !std::string_view(words[i + 1]).starts_with("--"))
            set(name, split(words[++i]), "", place);
        else
            set(name, {}, "", place);
    }
    if (const auto config = set_.find("config"); config != set_.end()) {
        if (config->second.values.size() != 1)
            throw InputError("", "--config", "has no value", "a TOML file");
        read_file(config_path(config->second.values[0]));
    }
}

void Parameters::declare(std::vector<std::span<const Parameter>> tables) {
    tables_ = std::move(tables);
    std::vector<std::string_view> names;
    for (const std::span<const Parameter> table : tables_)
        for (const Parameter& parameter : table)
            names.emplace_back(parameter.name);
    for (const auto& [name, value] : set_) {
        if (std::find(names.begin(), names.end(), name) == names.end())
            throw InputError(value.file, value.place, "is not a parameter of this experiment",
                             expected_name(name, names));
        const Parameter& parameter = declared(name);
        const bool is_flag = parameter.fallback == nullptr;
        const bool truth =
            value.values.size() == 1 && (value.values[0] == "true" || value.values[0] == "false");
        if (is_flag && !value.values.empty() && !truth)
            throw InputError(value.file, value.place, "is a switch", "true or false, or no value");
        if (!is_flag && value.values.empty())
            throw InputError(value.file, value.place, "has no value", parameter.help);
    }
}

const Parameter& Parameters::declared(const std::string& name) const {
    for (const std::span<const Parameter> table : tables_)
        for (const Parameter& parameter : table)
            if (name == parameter.name) return parameter;
    throw std::logic_error("parameter '" + name + "' is in no table");
}

std::string Parameters::first(const std::string& name) const {
    const auto value = set_.find(name);
    return value == set_.end() || value->second.values.empty() ? "" : value->second.values[0];
}

bool Parameters::flag(const std::string& name) const {
    const auto value = set_.find(name);
    return value != set_.end() && (value->second.values.empty() || value->second.values[0] == "true");
}

std::vector<std::string> Parameters::list(const std::string& name) const {
    const Parameter& parameter = declared(name);
    const auto value = set_.find(name);
    return value != set_.end() ? value->second.values : split(parameter.fallback);
}

std::string Parameters::text(const std::string& name) const {
    const std::vector<std::string> values = list(name);
    if (values.size() != 1) fail(name, "has several values", "one");
    return values[0];
}

double Parameters::parse_number(const std::string& name, const std::string& text, double low,
                                double high) const {
    double number = 0;
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    if (error != std::errc() || end != text.data() + text.size() || !(number >= low && number <= high))
        fail(name, fmt::format("'{}' cannot be used", text), fmt::format("{} to {}", low, high));
    return number;
}

double Parameters::number(const std::string& name, double low, double high) const {
    return parse_number(name, text(name), low, high);
}

std::vector<double> Parameters::numbers(const std::string& name, double low, double high) const {
    std::vector<double> numbers;
    for (const std::string& text : list(name))
        numbers.push_back(parse_number(name, text, low, high));
    return numbers;
}

std::uint64_t Parameters::whole(const std::string& name) const {
    const std::string word = text(name);
    std::uint64_t number = 0;
    const auto [end, error] = std::from_chars(word.data(), word.data() + word.size(), number);
    if (error != std::errc() || end != word.data() + word.size())
        fail(name, fmt::format("'{}' cannot be used", word), "a whole number from 0 on");
    return number;
}

Color Parameters::parse(const std::string& name, const std::string& text) const {
    Color color;
    if (!parse_color(text, color))
        fail(name, fmt::format("'{}' is no colour", text), "six hexadecimal digits, rrggbb, such as 001900");
    return color;
}

Color Parameters::color(const std::string& name) const {
    return parse(name, text(name));
}

std::vector<Color> Parameters::colors(const std::string& name) const {
    std::vector<Color> colors;
    for (const std::string& text : list(name))
        colors.push_back(parse(name, text));
    return colors;
}

void Parameters::fail(const std::string& name, const std::string& problem,
                      const std::string& expected) const {
    const auto value = set_.find(name);
    if (value == set_.end()) throw InputError("", "--" + name, problem, expected);
    throw InputError(value->second.file, value->second.place, problem, expected);
}

std::string help_of(std::span<const Parameter> table) {
    std::string text;
    for (const Parameter& parameter : table) {
        text += fmt::format("  --{:<18} {}", parameter.name, parameter.help);
        if (parameter.fallback != nullptr && *parameter.fallback != '\0')
            text += fmt::format(" ({})", parameter.fallback);
        text += '\n';
    }
    return text;
}

}  // namespace puckloop::coordinator
