#include "reproductions/exchange_boards.h"

#include "base/error.h"

#include <fmt/format.h>

namespace puckloop::tools {

namespace {

/// s of an attempt: the longest mean that was seen, and the pause of 5 s behind it. What is left over is cut.
constexpr double kAttempt = 27.0, kExchangeStartUp = 30.0;

std::string seconds(const std::optional<double>& value) {
    return value ? fmt::format("{:.3f}", *value) : std::string();
}

}  // namespace

std::vector<ReportedExchange> exchange_on_boards(const BoardExchanges& options) {
    TrialSpec spec;
    spec.folder = options.folder;
    spec.seed = options.seed;
    spec.seconds = kExchangeStartUp + kAttempt * static_cast<double>(options.attempts);
    TrialRobot caller{"caller", options.firmware, -0.2, -0.2, 0.0, 1, {}, 1},
        listener{"listener", options.firmware, 0.0, 0.0, 0.0, 0, {}, 1234};
    spec.robots = {caller, listener};
    std::vector<ReportedExchange> exchanges = read_exchanges(run_trial(spec).lines.at(0));
    if (exchanges.empty())
        throw RunError("no exchange was reported on UART2: the image must report as firmware/bluetooth does");
    if (exchanges.size() > options.attempts) exchanges.resize(options.attempts);
    return exchanges;
}

ExchangeTimes times_of(const std::vector<ReportedExchange>& exchanges) {
    ExchangeTimes times;
    times.attempts = exchanges.size();
    for (const ReportedExchange& one : exchanges) {
        if (one.failure == "nobody found")
            ++times.not_found;
        else if (!one.succeeded())
            ++times.failed_later;
        else if (one.total)
            times.totals.push_back(*one.total);
    }
    summarise(times);
    return times;
}

std::string exchanges_csv(const std::vector<ReportedExchange>& exchanges) {
    std::string rows = "exchange,ended_s,outcome,name_s,link_s,release_s,total_s\n";
    for (std::size_t i = 0; i < exchanges.size(); ++i) {
        const ReportedExchange& one = exchanges[i];
        const std::string outcome = !one.failure.empty() ? one.failure
                                    : one.answered       ? "answered"
                                                         : "no answer";
        rows += fmt::format("{},{:.3f},{},{},{},{},{}\n", i, one.seconds, outcome, seconds(one.name),
                            seconds(one.link), seconds(one.release), seconds(one.total));
    }
    return rows;
}

}  // namespace puckloop::tools
