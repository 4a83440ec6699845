#include "reproductions/exchange_log.h"

#include <array>
#include <cstdlib>
#include <string_view>

namespace puckloop::tools {

namespace {

/// The time of "linked in 9800 ms" where the line begins with `what`, s.
std::optional<double> time_of(const std::string& line, std::string_view what) {
    if (!line.starts_with(what) || !line.ends_with(" ms")) return std::nullopt;
    const std::size_t number = line.rfind(' ', line.size() - 4);
    if (number == std::string::npos) return std::nullopt;
    char* end = nullptr;
    const double milliseconds = std::strtod(line.c_str() + number, &end);
    if (std::string_view(end) != " ms") return std::nullopt;
    return milliseconds / 1000;
}

}  // namespace

std::vector<ReportedExchange> read_exchanges(const std::vector<RobotLine>& lines) {
    std::vector<ReportedExchange> exchanges;
    ReportedExchange open;
    const auto close = [&](double seconds) {
        open.seconds = seconds;
        exchanges.push_back(open);
        open = {};
    };
    for (const RobotLine& line : lines) {
        if (const auto name = time_of(line.text, "named ")) open.name = name;
        if (const auto link = time_of(line.text, "linked in ")) open.link = link;
        if (const auto release = time_of(line.text, "released in ")) open.release = release;
        if (line.text == "answered") open.answered = true;
        for (const char* failure : {"nobody found", "no name", "not linked"})
            if (line.text == failure) {
                open.failure = failure;
                close(line.seconds);
            }
        if (const auto total = time_of(line.text, "exchange ")) {
            open.total = total;
            close(line.seconds);
        }
    }
    return exchanges;
}

}  // namespace puckloop::tools
