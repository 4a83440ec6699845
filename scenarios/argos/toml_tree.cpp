#include "scenarios/argos/toml_tree.h"

#include <fmt/format.h>

#include <algorithm>

namespace puckloop::argos {

namespace {

TomlValue value_at(auto data, int line) {
    TomlValue value;
    value.data = std::move(data);
    value.line = line;
    return value;
}

std::string quoted(const std::string& text) {
    std::string result = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\') result += '\\';
        if (static_cast<unsigned char>(c) < 0x20 || c == 0x7F)
            result += fmt::format("\\u{:04X}", static_cast<unsigned>(static_cast<unsigned char>(c)));
        else
            result += c;
    }
    return result + "\"";
}

std::string plain_text(const TomlValue& value) {
    if (const auto* flag = std::get_if<bool>(&value.data)) return *flag ? "true" : "false";
    if (const auto* whole = std::get_if<std::int64_t>(&value.data)) return fmt::format("{}", *whole);
    if (const auto* text = std::get_if<std::string>(&value.data)) return quoted(*text);
    if (const auto* number = std::get_if<double>(&value.data)) {
        std::string text = fmt::format("{}", *number);
        if (text.find_first_of(".en") == std::string::npos) text += ".0";
        return text;
    }
    std::string list = "[";
    for (const TomlValue& item : std::get<TomlArray>(value.data))
        list += (list.size() > 1 ? ", " : "") + plain_text(item);
    return list + "]";
}

bool is_list_of_tables(const TomlValue& value) {
    const auto* array = std::get_if<TomlArray>(&value.data);
    return array && !array->empty() && array->front().is_table();
}

void write(const TomlTable& table, const std::string& path, std::string& text) {
    for (const auto& [key, value] : table)
        if (!value.is_table() && !is_list_of_tables(value))
            text += fmt::format("{} = {}\n", key, plain_text(value));
    for (const auto& [key, value] : table) {
        const std::string name = path.empty() ? key : path + "." + key;
        if (value.is_table()) {
            text += fmt::format("{}[{}]\n", path.empty() && !text.empty() ? "\n" : "", name);
            write(std::get<TomlTable>(value.data), name, text);
        } else if (is_list_of_tables(value)) {
            for (const TomlValue& item : std::get<TomlArray>(value.data)) {
                text += fmt::format("\n[[{}]]\n", name);
                write(std::get<TomlTable>(item.data), name, text);
            }
        }
    }
}

}  // namespace

Tree& Tree::set(const std::string& key, TomlValue value) {
    table_.emplace_back(key, std::move(value));
    return *this;
}

Tree& Tree::text(const std::string& key, const std::string& value) {
    return set(key, value_at(value, line_));
}

Tree& Tree::texts(const std::string& key, const std::vector<std::string>& values) {
    TomlArray array;
    for (const std::string& value : values)
        array.push_back(value_at(value, line_));
    return set(key, value_at(std::move(array), line_));
}

Tree& Tree::number(const std::string& key, double value) {
    return set(key, value_at(value, line_));
}

Tree& Tree::integer(const std::string& key, std::int64_t value) {
    return set(key, value_at(value, line_));
}

Tree& Tree::flag(const std::string& key, bool value) {
    return set(key, value_at(value, line_));
}

Tree& Tree::quantity(const std::string& key, double value, const char* unit) {
    return text(key, quantity_text(value, unit));
}

Tree& Tree::lengths(const std::string& key, const std::vector<double>& metres) {
    std::vector<std::string> texts_of;
    for (const double metre : metres)
        texts_of.push_back(quantity_text(metre, "m"));
    return texts(key, texts_of);
}

Tree& Tree::add(const std::string& key, const Tree& tree) {
    const auto found =
        std::find_if(table_.begin(), table_.end(), [&](const auto& entry) { return entry.first == key; });
    if (found == table_.end()) return set(key, value_at(TomlArray{tree.value()}, line_));
    std::get<TomlArray>(found->second.data).push_back(tree.value());
    return *this;
}

TomlValue Tree::value() const {
    return value_at(table_, line_);
}

std::string quantity_text(double value, const char* unit) {
    return fmt::format("{} {}", value == 0.0 ? 0.0 : value, unit);
}

TomlValue list_of(const std::vector<TomlValue>& items, int line) {
    return value_at(TomlArray(items.begin(), items.end()), line);
}

TomlValue text_value(const std::string& text, int line) {
    return value_at(text, line);
}

std::string toml_text(const TomlValue& root) {
    std::string text;
    write(std::get<TomlTable>(root.data), "", text);
    return text;
}

}  // namespace puckloop::argos
