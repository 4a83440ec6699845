#include "run/chips/value_words.h"

#include "base/error.h"
#include "base/json.h"

#include <fmt/format.h>

#include <cstdint>
#include <exception>
#include <regex>

namespace puckloop::tools {

namespace {

using nlohmann::json;
using nlohmann::ordered_json;

constexpr const char* kPlaces = "such as TMR1, U2STA.TRMT, a variable, 0x850:4";

std::uint64_t number_of_words(const std::string& text) {
    try {
        return std::stoull(text, nullptr, 0);
    } catch (const std::exception&) {
        throw InputError("", text, "is no number up to 64 bits");
    }
}

}  // namespace

void refuse_long_words(std::string_view text, const char* what) {
    // A regular expression's match takes some of the stack for each character.
    constexpr std::size_t kLongest = 500;
    if (text.size() > kLongest)
        throw InputError("", what, fmt::format("{} characters are too many", text.size()), "at most 500");
}

json place_of_words(std::string_view text) {
    static const std::regex memory(R"((0x[0-9a-fA-F]+|[0-9]+)(:([0-9]+))?)");
    static const std::regex name(R"(([A-Za-z_]\w*)(\.([A-Za-z_]\w*))?)");
    static const std::regex special(R"([A-Z][A-Z0-9_]*|w[0-9]+)");
    refuse_long_words(text, "read");
    const std::string typed(text);
    std::smatch parts;
    if (std::regex_match(typed, parts, memory)) {
        const std::uint64_t bytes = parts[3].matched ? number_of_words(parts[3]) : 2;
        return json::object({{"memory", number_of_words(parts[1])}, {"bytes", bytes}});
    }
    if (!std::regex_match(typed, parts, name))
        throw InputError("", "read", fmt::format("'{}' is no register, variable or address", typed), kPlaces);
    const std::string whole = parts[1];
    const bool is_register = parts[3].matched || std::regex_match(whole, special);
    json place = json::object({{is_register ? "register" : "variable", whole}});
    if (parts[3].matched) place["field"] = parts[3].str();
    return place;
}

std::optional<json> comparison_of_words(std::string_view text) {
    static const std::regex compared(R"((?:(\S+)\s+)?(\S+?)\s*(==|!=|<=|>=|<|>)\s*(0x[0-9a-fA-F]+|[0-9]+))");
    refuse_long_words(text, "condition");
    const std::string typed(text);
    std::smatch parts;
    if (!std::regex_match(typed, parts, compared)) return std::nullopt;
    json condition = place_of_words(parts[2].str());
    if (parts[1].matched) condition["node"] = parts[1].str();
    condition["is"] = parts[3].str();
    condition["value"] = number_of_words(parts[4]);
    return condition;
}

bool comparison_holds(std::uint64_t value, std::string_view is, std::uint64_t other) {
    if (is == "==") return value == other;
    if (is == "!=") return value != other;
    if (is == "<") return value < other;
    if (is == ">") return value > other;
    if (is == "<=") return value <= other;
    if (is == ">=") return value >= other;
    throw InputError("", "is", fmt::format("'{}' compares nothing", is), "==, !=, <, >, <= or >=");
}

std::string value_text(const ordered_json& reply) {
    if (!reply.contains("value")) return reply.value("data", "");
    if (reply.contains("field")) return reply.at("value").dump();
    const auto value = reply.at("value").get<std::uint64_t>();
    const int digits = reply.contains("bits") ? reply.at("bits").get<int>() / 4 : 2 * reply.value("bytes", 1);
    std::string text = fmt::format("0x{:0{}x} {}", value, digits, value);
    const ordered_json named = reply.value("fields", ordered_json(ordered_json::object()));
    for (const auto& one : named.items())
        if (one.value() != 0)
            text += one.value() == 1 ? fmt::format(" {}", one.key())
                                     : fmt::format(" {}={}", one.key(), one.value().dump());
    return text;
}

}  // namespace puckloop::tools
