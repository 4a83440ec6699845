#include "run/driven/words.h"

#include "base/error.h"
#include "base/json.h"
#include "run/chips/value_words.h"

#include <fmt/format.h>

#include <regex>
#include <sstream>

namespace puckloop::tools {

namespace {

using nlohmann::json;

constexpr const char* kConditions =
    R"(such as TMR1 >= 9, robot0.pic counter == 3, text "ok", frame link=robot0.uart value=4e)";

}  // namespace

json frame_of_words(std::string_view text) {
    json frame = json::object();
    std::istringstream words{std::string(text)};
    for (std::string word; words >> word;) {
        const std::size_t equals = word.find('=');
        if (equals == std::string::npos || equals == 0)
            throw InputError("", "frame", fmt::format("'{}' is no KEY=VALUE", word), kConditions);
        frame[word.substr(0, equals)] = word.substr(equals + 1);
    }
    return frame;
}

json condition_of_words(std::string_view text, const std::string& board) {
    static const std::regex quoted(R"re(text\s+"(.*)")re");
    constexpr std::string_view kFrame = "frame";
    refuse_long_words(text, "until");
    const std::string typed(text);
    std::smatch parts;
    if (std::regex_match(typed, parts, quoted)) {
        const json value = json::parse("\"" + parts[1].str() + "\"", nullptr, false);
        if (value.is_string()) return json::object({{"text", value}});
    } else if (typed == kFrame || typed.starts_with("frame ")) {
        return json::object({{"frame", frame_of_words(typed.substr(kFrame.size()))}});
    } else if (std::optional<json> condition = comparison_of_words(typed)) {
        condition->emplace("node", board);
        return *condition;
    }
    throw InputError("", "until", fmt::format("'{}' is no condition", typed), kConditions);
}

}  // namespace puckloop::tools
