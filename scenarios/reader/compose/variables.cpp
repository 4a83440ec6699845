#include "scenarios/reader/compose/variables.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "scenarios/values/reader.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <cmath>

namespace puckloop::scenarios {

namespace {

template <typename Number>
bool parse(const std::string& text, Number& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc{} && end == text.data() + text.size();
}

std::vector<std::string_view> names_of(const TomlTable& variables) {
    std::vector<std::string_view> names;
    for (const auto& entry : variables)
        names.emplace_back(entry.first);
    return names;
}

TomlValue* find(TomlTable& variables, std::string_view name) {
    const auto found = std::find_if(variables.begin(), variables.end(),
                                    [&](const auto& entry) { return entry.first == name; });
    return found == variables.end() ? nullptr : &found->second;
}

/// `text` as a value of the kind that `value` has.
void assign(TomlValue& value, const std::string& name, const std::string& text) {
    const auto fail = [&](const char* expected) {
        throw InputError("", "--set", fmt::format("{} cannot be '{}'", name, text), expected);
    };
    if (value.is_string()) {
        value.data = text;
    } else if (std::holds_alternative<bool>(value.data)) {
        if (text != "true" && text != "false") fail("true or false, as the scenario's value");
        value.data = text == "true";
    } else if (value.is_array() || value.is_table()) {
        fail("a variable that is a number, a text or a truth value: lists are the scenario's");
    } else {
        std::int64_t whole = 0;
        double number = 0.0;
        if (parse(text, whole))
            value.data = whole;
        else if (parse(text, number) && std::isfinite(number))
            value.data = number;
        else
            fail("a number, as the scenario's value");
    }
}

std::string as_text(const TomlValue& value) {
    if (const auto* text = std::get_if<std::string>(&value.data)) return *text;
    if (const auto* flag = std::get_if<bool>(&value.data)) return *flag ? "true" : "false";
    if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return fmt::format("{}", *whole);
    if (const auto* number = std::get_if<double>(&value.data)) return fmt::format("{}", *number);
    return {};
}

class Resolver {
  public:
    Resolver(TomlTable& variables, const std::string& file) : variables_(variables), file_(file) {}

    void resolve(TomlValue& value) {
        if (auto* table = std::get_if<TomlTable>(&value.data))
            for (auto& entry : *table)
                resolve(entry.second);
        else if (auto* array = std::get_if<TomlArray>(&value.data))
            for (TomlValue& item : *array)
                resolve(item);
        else if (value.is_string())
            resolve_text(value);
    }

  private:
    void resolve_text(TomlValue& value) {
        const std::string text = std::get<std::string>(value.data);
        std::string result;
        for (std::size_t at = 0; at < text.size();) {
            const auto dollar = text.find("${", at);
            result += text.substr(at, dollar == std::string::npos ? dollar : dollar - at);
            if (dollar == std::string::npos) break;
            if (dollar > at && text[dollar - 1] == '$') {  // "$${"
                result += "{";
                at = dollar + 2;
                continue;
            }
            const auto end = text.find('}', dollar);
            if (end == std::string::npos) fail(value, "'${' without '}'", "${NAME}, or $${ for a plain ${");
            const TomlValue& named = look_up(value, text.substr(dollar + 2, end - dollar - 2));
            if (dollar == 0 && end + 1 == text.size()) {  // the value itself
                value.data = named.data;
                return;
            }
            if (named.is_array() || named.is_table())
                fail(value, fmt::format("'{}' is a list, which is no part of a text", text),
                     "the variable alone");
            result += as_text(named);
            at = end + 1;
        }
        value.data = std::move(result);
    }

    const TomlValue& look_up(const TomlValue& value, const std::string& name) {
        if (const TomlValue* found = find(variables_, name)) return *found;
        fail(value,
             fmt::format("there is no variable '{}'{}", name, did_you_mean(name, names_of(variables_))),
             "a name of [variables]");
    }

    [[noreturn]] void fail(const TomlValue& value, const std::string& problem,
                           std::string_view expected) const {
        throw InputError(value.source ? *value.source : file_,
                         value.line > 0 ? fmt::format("line {}", value.line) : "", problem, expected);
    }

    TomlTable& variables_;
    const std::string& file_;
};

}  // namespace

void resolve_variables(TomlValue& root, const std::string& file, const std::vector<std::string>& set) {
    auto& top = std::get<TomlTable>(root.data);
    Reader reader(file, "", root);
    TomlTable variables;
    const bool any = reader.table("variables") != nullptr;
    if (const TomlValue* table = reader.table("variables")) variables = std::get<TomlTable>(table->data);
    for (const std::string& assignment : set) {
        const auto equals = assignment.find('=');
        if (equals == std::string::npos || equals == 0)
            throw InputError("", "--set", fmt::format("'{}' is no assignment", assignment), "NAME=VALUE");
        const std::string name = assignment.substr(0, equals);
        TomlValue* value = find(variables, name);
        if (!value)
            throw InputError(file, "",
                             fmt::format("has no variable '{}' that --set could change{}", name,
                                         did_you_mean(name, names_of(variables))),
                             variables.empty()
                                 ? "a table [variables]"
                                 : fmt::format("one of {}", fmt::join(names_of(variables), ", ")));
        assign(*value, name, assignment.substr(equals + 1));
    }
    if (!any) return;
    std::erase_if(top, [](const auto& entry) { return entry.first == "variables"; });
    Resolver(variables, file).resolve(root);
}

}  // namespace puckloop::scenarios
