#include "scenarios/reader/faults/fault_words.h"

#include "base/error.h"

#include <fmt/format.h>

#include <algorithm>
#include <charconv>
#include <string>
#include <vector>

namespace puckloop::scenarios {

namespace {

constexpr std::string_view kShape = "KIND KEY=VALUE..., such as drop link=robot0.uart at=2s";

[[noreturn]] void refuse(std::string_view words, const std::string& problem) {
    throw InputError("", fmt::format("--fault \"{}\"", words), problem, kShape);
}

/// Words between blanks; what is in double quotes is one, and loses them.
std::vector<std::string> split(std::string_view words) {
    std::vector<std::string> list;
    bool in_word = false, in_quotes = false;
    for (const char c : words) {
        const bool blank = c == ' ' || c == '\t' || c == '\n';
        if (blank && !in_quotes) {
            in_word = false;
            continue;
        }
        if (!in_word) list.emplace_back();
        in_word = true;
        if (c == '"')
            in_quotes = !in_quotes;
        else
            list.back() += c;
    }
    if (in_quotes) refuse(words, "a quote is open at the end");
    return list;
}

template <class Number>
bool is_whole(std::string_view text, Number& number) {
    const auto [end, error] = std::from_chars(text.data(), text.data() + text.size(), number);
    return error == std::errc() && end == text.data() + text.size();
}

/// As TOML would have it: numbers and flags bare, all else a text.
TomlValue value_of(std::string_view text) {
    std::int64_t whole = 0;
    double real = 0;
    if (is_whole(text, whole)) return {whole};
    if (is_whole(text, real)) return {real};
    if (text == "true" || text == "false") return {text == "true"};
    return {std::string(text)};
}

TomlValue list_of(std::string_view text) {
    TomlArray items;
    while (true) {
        const std::size_t comma = text.find(',');
        items.push_back({std::string(text.substr(0, comma))});
        if (comma == std::string_view::npos) return {items};
        text.remove_prefix(comma + 1);
    }
}

}  // namespace

TomlValue fault_table_of(std::string_view words) {
    const std::vector<std::string> list = split(words);
    if (list.empty()) refuse(words, "no fault given");
    TomlTable table;
    for (const std::string& word : list) {
        const std::size_t equals = word.find('=');
        const bool is_kind = &word == &list.front() && equals == std::string::npos;
        const std::string key = is_kind ? "kind" : word.substr(0, equals);
        if (equals == 0 || (!is_kind && equals == std::string::npos))
            refuse(words, fmt::format("'{}' is no KEY=VALUE", word));
        const std::string_view text = is_kind ? word : std::string_view(word).substr(equals + 1);
        if (std::any_of(table.begin(), table.end(), [&](const auto& one) { return one.first == key; }))
            refuse(words, fmt::format("'{}' is given twice", key));
        // A name is a text whatever it looks like.
        const bool is_text = key == "kind" || key == "name" || key == "link" || key == "node" ||
                             key == "from" || key == "match" || key == "data" || key == "image" ||
                             key == "sha256" || key == "source";
        table.emplace_back(key, key == "bytes" ? list_of(text)
                                : is_text      ? TomlValue{std::string(text)}
                                               : value_of(text));
    }
    std::sort(table.begin(), table.end(), [](const auto& a, const auto& b) { return a.first < b.first; });
    return {table};
}

}  // namespace puckloop::scenarios
