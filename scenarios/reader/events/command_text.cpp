#include "scenarios/reader/events/command_text.h"

#include "base/error.h"
#include "base/text/suggest.h"
#include "scenarios/reader/events/action_forms.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>

namespace puckloop::scenarios {

namespace {

struct Word {
    std::string text;
    bool quoted = false;
};

[[noreturn]] void fail(std::string_view problem, std::string_view expected = {}) {
    throw InputError("", "command", problem, expected);
}

/// Well-formed UTF-8: what JSON and TOML files can hold.
bool is_utf8(std::string_view text) {
    for (std::size_t i = 0; i < text.size();) {
        const auto byte = [&](std::size_t k) {
            return i + k < text.size() ? static_cast<unsigned char>(text[i + k]) : 0U;
        };
        const unsigned first = byte(0);
        const std::size_t length = first < 0x80 ? 1 : first >= 0xF0 ? 4 : first >= 0xE0 ? 3 : 2;
        if (first >= 0x80 && (first < 0xC2 || first > 0xF4)) return false;
        for (std::size_t k = 1; k < length; ++k)
            if ((byte(k) & 0xC0U) != 0x80U) return false;
        // No overlong forms, no surrogates, nothing above U+10FFFF.
        const bool wrong = (first == 0xE0 && byte(1) < 0xA0) || (first == 0xED && byte(1) > 0x9F) ||
                           (first == 0xF0 && byte(1) < 0x90) || (first == 0xF4 && byte(1) > 0x8F);
        if (wrong) return false;
        i += length;
    }
    return true;
}

/// Separated by spaces; "..." is one word.
std::vector<Word> words_of(std::string_view text) {
    std::vector<Word> words;
    for (std::size_t i = 0; i < text.size();) {
        const char c = text[i];
        if (c == ' ' || c == '\t') {
            ++i;
            continue;
        }
        const bool quoted = c == '"';
        const std::size_t from = quoted ? i + 1 : i;
        const std::size_t end = std::min(quoted ? text.find('"', from) : text.find_first_of(" \t\"", from),
                                         quoted ? std::string_view::npos : text.size());
        if (end == std::string_view::npos) fail("a quote is not closed", "\"...\"");
        words.push_back({std::string(text.substr(from, end - from)), quoted});
        i = end + (quoted ? 1 : 0);
    }
    return words;
}

const ActionKey* key_of(std::span<const ActionKey> keys, const Word& word) {
    if (word.quoted) return nullptr;
    const auto found =
        std::find_if(keys.begin(), keys.end(), [&](const ActionKey& key) { return key.name == word.text; });
    return found == keys.end() ? nullptr : &*found;
}

TomlValue text_value(std::string text) {
    TomlValue value;
    value.data = std::move(text);
    return value;
}

std::string_view trimmed(std::string_view text) {
    while (!text.empty() && text.front() == ' ')
        text.remove_prefix(1);
    while (!text.empty() && text.back() == ' ')
        text.remove_suffix(1);
    return text;
}

TomlValue value_of(const std::string& text, ValueForm form) {
    if (form == ValueForm::Integer) {
        std::int64_t number = 0;
        const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
        if (error != std::errc() || end != text.data() + text.size()) return text_value(text);
        TomlValue value;
        value.data = number;
        return value;
    }
    if (form == ValueForm::Text) return text_value(text);
    TomlArray items;
    std::string_view rest = text;
    while (true) {
        const auto comma = rest.find(',');
        items.push_back(text_value(std::string(trimmed(rest.substr(0, comma)))));
        if (comma == std::string_view::npos) break;
        rest.remove_prefix(comma + 1);
    }
    TomlValue value;
    value.data = std::move(items);
    return value;
}

std::string known_verbs() {
    std::string list;
    for (const ActionForm& form : action_forms())
        list += fmt::format("{}{}", list.empty() ? "" : ", ", form.verb);
    return list;
}

/// A text in a command: quoted where its words would be taken apart or taken for keys.
std::string in_command(const std::string& text, std::span<const ActionKey> keys) {
    const bool plain = !text.empty() && text.find_first_of(" \t\"") == std::string::npos &&
                       key_of(keys, {text, false}) == nullptr;
    return plain ? text : '"' + text + '"';
}

std::string toml_string(std::string_view text) {
    std::string quoted = "\"";
    for (const char c : text) {
        if (c == '"' || c == '\\')
            quoted += fmt::format("\\{}", c);
        else if (static_cast<unsigned char>(c) < ' ' || c == 0x7F)
            quoted += fmt::format("\\u{:04x}", static_cast<unsigned>(static_cast<unsigned char>(c)));
        else
            quoted += c;
    }
    return quoted + '"';
}

std::string plain_value(const TomlValue& value, const ActionKey& key, std::span<const ActionKey> keys) {
    if (const auto* text = std::get_if<std::string>(&value.data))
        return key.name == "name" || key.name == "text" ? in_command(*text, keys) : *text;
    if (const auto* items = std::get_if<TomlArray>(&value.data)) {
        std::string list;
        for (const TomlValue& item : *items)
            list += (list.empty() ? "" : ", ") + plain_value(item, key, keys);
        return list;
    }
    return toml_value(value);
}

const TomlValue* find(const TomlValue& table, std::string_view key) {
    for (const auto& [name, value] : std::get<TomlTable>(table.data))
        if (name == key) return &value;
    return nullptr;
}

}  // namespace

TomlValue parse_command_text(std::string_view text) {
    constexpr std::size_t kLongest = 4096;
    if (text.size() > kLongest) fail("it is too long", "at most 4096 characters");
    if (!is_utf8(text)) fail("it is not text", "UTF-8");
    if (std::any_of(text.begin(), text.end(),
                    [](char c) { return (c >= 0 && c < ' ' && c != '\t') || c == 0x7F; }))
        fail("there is a control character in it", "one line of words");
    const std::vector<Word> words = words_of(text);
    if (words.empty()) fail("it is empty", "such as \"move can to 10 cm, 0 cm\"");
    const std::string& verb = words[0].text;
    if (action_form(verb) == nullptr) {
        std::vector<std::string_view> verbs;
        for (const ActionForm& form : action_forms())
            verbs.push_back(form.verb);
        const std::string meant = nearest_name(verb, verbs);
        fail(fmt::format("'{}' is unknown", verb),
             meant.empty() ? "list, or one of " + known_verbs() : fmt::format("perhaps '{}'", meant));
    }
    // Of add the first word is the kind, which decides what the keys are.
    const auto keys = keys_of(verb, words.size() > 1 ? words[1].text : "");
    TomlTable table;
    std::string key = verb;
    ValueForm form = ValueForm::Text;
    std::string value;
    const auto close = [&] {
        if (value.empty()) fail(fmt::format("'{}' has no value", key), std::string(action_form(verb)->usage));
        for (const auto& [name, other] : table)
            if (name == key) fail(fmt::format("'{}' is there twice", key));
        table.emplace_back(key, value_of(value, form));
        value.clear();
    };
    for (std::size_t i = 1; i < words.size(); ++i) {
        if (const ActionKey* next = key_of(keys, words[i]); next != nullptr) {
            close();
            key = next->name;
            form = next->form;
        } else {
            value += (value.empty() ? "" : " ") + words[i].text;
        }
    }
    close();
    std::sort(table.begin(), table.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    TomlValue result;
    result.data = std::move(table);
    return result;
}

std::string verb_of(const TomlValue& table) {
    std::string verb;
    for (const auto& [name, value] : std::get<TomlTable>(table.data)) {
        if (action_form(name) == nullptr) continue;
        if (!verb.empty()) return {};
        verb = name;
    }
    return verb;
}

std::string command_text(const TomlValue& table) {
    const std::string verb = verb_of(table);
    const auto* object = std::get_if<std::string>(&find(table, verb)->data);
    const auto keys = keys_of(verb, object == nullptr ? "" : *object);
    std::string text = verb + " " + (object == nullptr ? "" : in_command(*object, keys));
    for (const ActionKey& key : keys)
        if (const TomlValue* value = find(table, key.name); value != nullptr)
            text += fmt::format(" {} {}", key.name, plain_value(*value, key, keys));
    return text;
}

std::string toml_value(const TomlValue& value) {
    if (const auto* text = std::get_if<std::string>(&value.data)) return toml_string(*text);
    if (const auto* number = std::get_if<std::int64_t>(&value.data)) return fmt::format("{}", *number);
    if (const auto* number = std::get_if<double>(&value.data)) {
        const std::string text = fmt::format("{}", *number);
        return text.find_first_of(".en") == std::string::npos ? text + ".0" : text;
    }
    if (const auto* flag = std::get_if<bool>(&value.data)) return *flag ? "true" : "false";
    std::string list;
    if (const auto* items = std::get_if<TomlArray>(&value.data))
        for (const TomlValue& item : *items)
            list += (list.empty() ? "" : ", ") + toml_value(item);
    return "[" + list + "]";
}

std::string toml_text(const TomlValue& table) {
    const std::string verb = verb_of(table);
    const auto* object = std::get_if<std::string>(&find(table, verb)->data);
    std::string text = fmt::format("{} = {}\n", verb, toml_string(object == nullptr ? "" : *object));
    for (const ActionKey& key : keys_of(verb, object == nullptr ? "" : *object))
        if (const TomlValue* value = find(table, key.name); value != nullptr)
            text += fmt::format("{} = {}\n", key.name, toml_value(*value));
    return text;
}

}  // namespace puckloop::scenarios
