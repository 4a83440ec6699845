#include "tools/shell/words.h"

#include "base/error.h"

#include <fmt/format.h>
#include <nlohmann/json.hpp>

#include <cstdint>
#include <regex>
#include <sstream>

namespace puckloop::tools {

namespace {

using nlohmann::json;

constexpr const char* kConditions =
    R"(such as TMR1 >= 9, robot0.pic counter == 3, text "ok", frame link=robot0.uart value=4e)";

std::uint64_t number_of(const std::string& text) {
    try {
        return std::stoull(text, nullptr, 0);
    } catch (const std::exception&) {
        throw InputError("", text, "is too large a number");
    }
}

}  // namespace

std::optional<json> place_words(std::string_view text, std::string& field) {
    static const std::regex memory(R"((0x[0-9a-fA-F]+|[0-9]+)(:([0-9]+))?)");
    static const std::regex name(R"(([A-Za-z_]\w*)(\.([A-Za-z_]\w*))?)");
    static const std::regex special(R"([A-Z][A-Z0-9_]*|w[0-9]+)");
    field.clear();
    const std::string typed(text);
    std::smatch parts;
    if (std::regex_match(typed, parts, memory)) {
        const std::uint64_t bytes = parts[3].matched ? number_of(parts[3]) : 2;
        return json::object({{"memory", number_of(parts[1])}, {"bytes", bytes}});
    }
    if (!std::regex_match(typed, parts, name)) return std::nullopt;
    field = parts[3];
    const std::string whole = parts[1];
    const bool is_register = !field.empty() || std::regex_match(whole, special);
    return json::object({{is_register ? "register" : "variable", whole}});
}

json condition_words(std::string_view text, const std::string& board) {
    static const std::regex quoted(R"re(text\s+"(.*)")re");
    static const std::regex compared(R"((?:(\S+)\s+)?(\S+?)\s*(==|!=|<=|>=|<|>)\s*(0x[0-9a-fA-F]+|[0-9]+))");
    const std::string typed(text);
    std::smatch parts;
    if (std::regex_match(typed, parts, quoted)) {
        const json value = json::parse("\"" + parts[1].str() + "\"", nullptr, false);
        if (value.is_string()) return json::object({{"text", value}});
    } else if (typed == "frame" || typed.starts_with("frame ")) {
        json frame = json::object();
        std::istringstream words(typed.substr(std::string_view("frame").size()));
        for (std::string word; words >> word;) {
            const std::size_t equals = word.find('=');
            if (equals == std::string::npos || equals == 0)
                throw InputError("", word, "is no KEY=VALUE", kConditions);
            frame[word.substr(0, equals)] = word.substr(equals + 1);
        }
        return json::object({{"frame", frame}});
    } else if (std::regex_match(typed, parts, compared)) {
        std::string field;
        auto place = place_words(parts[2].str(), field);
        if (place && field.empty()) {
            json condition = *place;
            condition["node"] = parts[1].matched ? parts[1].str() : board;
            condition["is"] = parts[3].str();
            condition["value"] = number_of(parts[4]);
            return condition;
        }
    }
    throw InputError("", "until", fmt::format("'{}' is no condition", typed), kConditions);
}

}  // namespace puckloop::tools
