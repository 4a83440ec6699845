#include "view/live/network_status.h"

#include "base/json.h"

#include <charconv>
#include <fstream>
#include <set>
#include <string_view>
#include <system_error>

namespace puckloop::view {

namespace {

namespace fs = std::filesystem;
using nlohmann::ordered_json;

constexpr std::string_view kLogSuffix = ".linux.log", kStatusWord = "status ", kStatusBegin = "{\"time_s\":";

std::string end_of_file(const fs::path& file) {
    std::ifstream in(file, std::ios::binary | std::ios::ate);
    const std::streamoff size = in ? static_cast<std::streamoff>(in.tellg()) : 0;
    const auto wanted = std::min<std::streamoff>(size, static_cast<std::streamoff>(kMostStatusBytes));
    std::string text(static_cast<std::size_t>(std::max<std::streamoff>(wanted, 0)), '\0');
    in.seekg(size - wanted);
    in.read(text.data(), wanted);
    text.resize(static_cast<std::size_t>(std::max<std::streamsize>(in.gcount(), 0)));
    return text;
}

/// Of a line that is a whole status no later than `time`: its JSON; else nothing.
std::string_view status_in(std::string_view line, double time) {
    if (!line.starts_with(kStatusWord)) return {};
    line.remove_prefix(kStatusWord.size());
    if (!line.starts_with(kStatusBegin)) return {};
    double when = 0;
    const char* const end = line.data() + line.size();
    if (std::from_chars(line.data() + kStatusBegin.size(), end, when).ec != std::errc() || !(when <= time))
        return {};
    return line;
}

}  // namespace

std::string network_status(const fs::path& folder, double time) {
    std::set<std::string> logs;
    std::error_code none;
    for (const auto& entry : fs::directory_iterator(folder, none))
        if (const std::string name = entry.path().filename().string(); name.ends_with(kLogSuffix))
            logs.insert(name);
    ordered_json list = ordered_json::array();
    for (const std::string& name : logs) {
        const std::string text = end_of_file(folder / name);
        std::string_view found;
        for (std::size_t begin = 0; begin < text.size();) {
            const std::size_t end = text.find('\n', begin);
            if (end == std::string::npos) break;
            const auto status = status_in(std::string_view(text).substr(begin, end - begin), time);
            if (!status.empty()) found = status;
            begin = end + 1;
        }
        if (found.empty()) continue;
        auto status = ordered_json::parse(found, nullptr, false);
        if (!status.is_object()) continue;
        list.push_back(
            {{"computer", name.substr(0, name.size() - kLogSuffix.size())}, {"status", std::move(status)}});
    }
    return list.dump(-1, ' ', false, ordered_json::error_handler_t::replace);
}

}  // namespace puckloop::view
