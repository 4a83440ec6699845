#include "scenarios/values/reader.h"

#include "base/error.h"
#include "base/text/suggest.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::scenarios {

namespace {

std::string joined(const std::vector<std::string>& words) {
    return fmt::format("{}", fmt::join(words, ", "));
}

}  // namespace

std::string place_of(const TomlValue& value) {
    if (value.line <= 0) return {};  // what does not come from a file has no lines
    return value.source ? fmt::format("line {} of {}", value.line, *value.source)
                        : fmt::format("line {}", value.line);
}

Reader::Reader(std::string file, std::string where, const TomlValue& table)
    : file_(std::move(file)), where_(std::move(where)), table_(table) {
    if (!table.is_table())
        fail_at(table, fmt::format("{} is not a table", where_), fmt::format("[{}]", where_));
}

void Reader::fail_at(const TomlValue& value, const std::string& problem, std::string_view expected) const {
    const std::string place = value.line > 0 ? fmt::format("line {}", value.line) : std::string{};
    throw InputError(value.source ? *value.source : file_, place, problem, expected);
}

std::filesystem::path Reader::folder() const {
    return std::filesystem::path(table_.source ? *table_.source : file_).parent_path();
}

const TomlValue* Reader::find(std::string_view key) {
    if (std::find(asked_.begin(), asked_.end(), key) == asked_.end()) asked_.emplace_back(key);
    for (const auto& [name, value] : std::get<TomlTable>(table_.data))
        if (name == key) return &value;
    return nullptr;
}

const TomlValue& Reader::require(std::string_view key) {
    const TomlValue* value = find(key);
    if (!value) fail_missing(key);
    return *value;
}

void Reader::fail_missing(std::string_view key, std::string_view expected) {
    // A key that is near to it and that nobody asked for is the same one, misspelt.
    for (const auto& [name, value] : std::get<TomlTable>(table_.data)) {
        if (std::find(asked_.begin(), asked_.end(), name) != asked_.end()) continue;
        if (!nearest_name(name, {key}).empty()) fail_unknown(name, value, std::string(key));
    }
    fail(key, fmt::format("'{}' is missing", key), expected);
}

void Reader::fail_unknown(std::string_view name, const TomlValue& value, const std::string& meant) const {
    const std::string prefix = where_.empty() ? std::string{} : where_ + ": ";
    fail_at(value, fmt::format("{}unknown key '{}'", prefix, name),
            meant.empty() ? fmt::format("one of {}", joined(asked_)) : fmt::format("perhaps '{}'", meant));
}

bool Reader::has(std::string_view key) {
    return find(key) != nullptr;
}

bool Reader::is_text(std::string_view key) {
    const TomlValue* value = find(key);
    return value && value->is_string();
}

int Reader::line_of(std::string_view key) {
    const TomlValue* value = find(key);
    return value ? value->line : table_.line;
}

void Reader::fail(std::string_view key, std::string_view problem, std::string_view expected) {
    const std::string prefix = where_.empty() ? std::string{} : where_ + ": ";
    const TomlValue* value = find(key);
    fail_at(value ? *value : table_, prefix + std::string(problem), expected);
}

double Reader::number(std::string_view key, const TomlValue& value, Dimension dimension) {
    const bool unitless = dimension == Dimension::Ratio || dimension == Dimension::Number;
    if (const auto* text = std::get_if<std::string>(&value.data)) {
        try {
            return parse_quantity(*text, dimension);
        } catch (const QuantityError& error) {
            fail(key, fmt::format("{}: {}", key, error.problem), error.expected);
        }
    }
    double plain = 0.0;
    if (const auto* integer = std::get_if<std::int64_t>(&value.data))
        plain = static_cast<double>(*integer);
    else if (const auto* real = std::get_if<double>(&value.data))
        plain = *real;
    else
        fail(key, fmt::format("{} is not a quantity", key), example_of(dimension));
    if (!std::isfinite(plain))
        fail(key, fmt::format("{}: {} is not finite", key, plain), example_of(dimension));
    if (!unitless) fail(key, fmt::format("{}: {} has no unit", key, plain), example_of(dimension));
    return plain;
}

double Reader::quantity(std::string_view key, Dimension dimension) {
    return number(key, require(key), dimension);
}

double Reader::quantity(std::string_view key, Dimension dimension, double fallback) {
    const TomlValue* value = find(key);
    return value ? number(key, *value, dimension) : fallback;
}

std::optional<double> Reader::optional_quantity(std::string_view key, Dimension dimension) {
    const TomlValue* value = find(key);
    if (!value) return std::nullopt;
    return number(key, *value, dimension);
}

std::vector<double> Reader::numbers(std::string_view key, const TomlValue& value, Dimension dimension,
                                    std::size_t count) {
    const auto* array = std::get_if<TomlArray>(&value.data);
    if (!array || array->size() != count)
        fail(key, fmt::format("{} is not a list of {}", key, count),
             fmt::format("{}, each {}", count, example_of(dimension)));
    std::vector<double> result;
    for (const TomlValue& item : *array)
        result.push_back(number(key, item, dimension));
    return result;
}

std::vector<double> Reader::quantities(std::string_view key, Dimension dimension, std::size_t count) {
    return numbers(key, require(key), dimension, count);
}

std::vector<std::vector<double>> Reader::quantity_lists(std::string_view key, Dimension dimension,
                                                        std::size_t count) {
    const TomlValue& value = require(key);
    const auto* array = std::get_if<TomlArray>(&value.data);
    if (!array) fail(key, fmt::format("{} is not a list of lists", key), example_of(dimension));
    std::vector<std::vector<double>> result;
    for (const TomlValue& item : *array)
        result.push_back(numbers(key, item, dimension, count));
    return result;
}

const TomlArray& Reader::list(std::string_view key, const TomlValue& value) {
    const auto* array = std::get_if<TomlArray>(&value.data);
    if (!array) fail(key, fmt::format("{} is not a list", key), "numbers in brackets");
    return *array;
}

std::vector<double> Reader::bare_numbers(std::string_view key) {
    const TomlValue* value = find(key);
    if (!value) return {};
    return numbers(key, *value, Dimension::Number, list(key, *value).size());
}

std::vector<std::vector<double>> Reader::bare_number_lists(std::string_view key) {
    const TomlValue* value = find(key);
    std::vector<std::vector<double>> result;
    if (!value) return result;
    for (const TomlValue& one : list(key, *value))
        result.push_back(numbers(key, one, Dimension::Number, list(key, one).size()));
    return result;
}

std::string Reader::text(std::string_view key) {
    const TomlValue& value = require(key);
    const auto* string = std::get_if<std::string>(&value.data);
    if (!string) fail(key, fmt::format("{} is not a text", key), "text in quotes");
    return *string;
}

std::string Reader::text(std::string_view key, std::string_view fallback) {
    return find(key) ? text(key) : std::string(fallback);
}

std::int64_t Reader::integer(std::string_view key, std::int64_t fallback, std::int64_t low,
                             std::int64_t high) {
    const TomlValue* value = find(key);
    if (!value) return fallback;
    const auto* integer = std::get_if<std::int64_t>(&value->data);
    if (!integer || *integer < low || *integer > high)
        fail(key, fmt::format("{} is out of range", key),
             fmt::format("a whole number from {} to {}", low, high));
    return *integer;
}

bool Reader::flag(std::string_view key, bool fallback) {
    const TomlValue* value = find(key);
    if (!value) return fallback;
    const auto* boolean = std::get_if<bool>(&value->data);
    if (!boolean) fail(key, fmt::format("{} is neither true nor false", key), "true or false");
    return *boolean;
}

std::vector<std::string> Reader::texts(std::string_view key) {
    const TomlValue* value = find(key);
    if (!value) return {};
    if (const auto* single = std::get_if<std::string>(&value->data)) return {*single};
    std::vector<std::string> result;
    const auto* array = std::get_if<TomlArray>(&value->data);
    if (array)
        for (const TomlValue& item : *array)
            if (const auto* string = std::get_if<std::string>(&item.data)) result.push_back(*string);
    if (!array || result.size() != array->size())
        fail(key, fmt::format("{} is not a list of texts", key), "[\"a\", \"b\"]");
    return result;
}

std::string Reader::choice(std::string_view key, std::string_view fallback,
                           const std::vector<std::string>& choices) {
    const std::string value = text(key, fallback);
    if (std::find(choices.begin(), choices.end(), value) == choices.end())
        fail(key, fmt::format("{}: '{}' is not known", key, value), "one of " + joined(choices));
    return value;
}

const TomlValue* Reader::table(std::string_view key) {
    const TomlValue* value = find(key);
    if (value && !value->is_table())
        fail(key, fmt::format("{} is not a table", key), fmt::format("[{}]", key));
    return value;
}

std::vector<const TomlValue*> Reader::tables(std::string_view key) {
    const TomlValue* value = find(key);
    if (!value) return {};
    const auto* array = std::get_if<TomlArray>(&value->data);
    std::vector<const TomlValue*> result;
    if (array)
        for (const TomlValue& item : *array)
            if (item.is_table()) result.push_back(&item);
    if (!array || result.size() != array->size())
        fail(key, fmt::format("{} is not a list of tables", key), fmt::format("[[{}]]", key));
    return result;
}

const TomlTable& Reader::everything() {
    const auto& table = std::get<TomlTable>(table_.data);
    for (const auto& entry : table)
        find(entry.first);
    return table;
}

void Reader::finish() const {
    for (const auto& [name, value] : std::get<TomlTable>(table_.data)) {
        if (std::find(asked_.begin(), asked_.end(), name) != asked_.end()) continue;
        fail_unknown(name, value, nearest_name(name, {asked_.begin(), asked_.end()}));
    }
}

}  // namespace puckloop::scenarios
