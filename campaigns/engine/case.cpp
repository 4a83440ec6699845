#include "campaigns/engine/case.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <string_view>

namespace puckloop::faults {

using nlohmann::json;

namespace {

/// Keys that come first, in this order; the others follow by name.
constexpr std::array<std::string_view, 6> kFirst{"kind", "link", "node", "from", "begin", "end"};

std::vector<std::string> keys_of(const json& fault) {
    std::vector<std::string> keys;
    for (const std::string_view key : kFirst)
        if (fault.contains(std::string(key))) keys.emplace_back(key);
    for (const auto& [key, value] : fault.items())
        if (std::find(kFirst.begin(), kFirst.end(), key) == kFirst.end()) keys.push_back(key);
    return keys;
}

/// JSON's text of strings, numbers, flags and lists is TOML's; tables have '=' in place of ':'.
std::string toml_text(const json& value) {
    if (!value.is_object()) return value.dump();
    std::string text;
    for (const auto& [key, item] : value.items())
        text += fmt::format("{}{} = {}", text.empty() ? "" : ", ", key, toml_text(item));
    return "{ " + text + " }";
}

}  // namespace

json to_json(const Case& one) {
    return {{"id", one.id},     {"phase", one.phase},   {"sweep", one.sweep}, {"place", one.place},
            {"seed", one.seed}, {"faults", one.faults}, {"of", one.of},       {"pruned", one.pruned}};
}

Case case_from_json(const json& text) {
    Case one;
    one.id = text.at("id");
    one.phase = text.at("phase");
    one.sweep = text.at("sweep");
    one.place = text.at("place");
    one.seed = text.at("seed");
    one.faults = text.at("faults").get<std::vector<json>>();
    one.of = text.at("of");
    one.pruned = text.at("pruned");
    return one;
}

std::string value_text(const json& value) {
    if (value.is_string()) return value.get<std::string>();
    return value.dump();
}

std::string in_one_line(const std::vector<json>& faults) {
    std::string line;
    for (const json& fault : faults) {
        if (!line.empty()) line += " + ";
        bool first = true;
        for (const std::string& key : keys_of(fault)) {
            std::string value = value_text(fault.at(key));
            value.erase(std::remove(value.begin(), value.end(), ' '), value.end());
            line += fmt::format("{}{}={}", first ? "" : " ", key, value);
            first = false;
        }
    }
    return line;
}

std::string as_words(const json& fault) {
    std::string words = value_text(fault.value("kind", json("drop")));
    for (const std::string& key : keys_of(fault)) {
        if (key == "kind") continue;
        std::string value;
        if (fault.at(key).is_array())
            for (const json& item : fault.at(key))
                value += (value.empty() ? "" : ",") + value_text(item);
        else
            value = value_text(fault.at(key));
        const bool blank = value.empty() || value.find(' ') != std::string::npos;
        words += blank ? fmt::format(" {}=\"{}\"", key, value) : fmt::format(" {}={}", key, value);
    }
    return words;
}

std::string as_toml(const std::vector<json>& faults) {
    std::string text;
    for (const json& fault : faults) {
        text += "[[fault]]\n";
        for (const std::string& key : keys_of(fault))
            text += fmt::format("{} = {}\n", key, toml_text(fault.at(key)));
    }
    return text;
}

std::string kind_and_link(const json& fault) {
    std::string text = value_text(fault.value("kind", json("drop")));
    for (const char* place : {"link", "node", "on"})
        if (fault.contains(place)) text += " on " + value_text(fault.at(place));
    if (fault.contains("from")) text += " from " + value_text(fault.at("from"));
    return text;
}

}  // namespace puckloop::faults
