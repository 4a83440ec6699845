#include "reproductions/exchange_times.h"

#include "base/pages/chart.h"
#include "base/quantile.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::tools {

double ExchangeTimes::failed_percent() const {
    return attempts == 0 ? 0.0 : 100.0 * static_cast<double>(failures()) / static_cast<double>(attempts);
}

double ExchangeTimes::quantile(double share) const {
    return totals.empty() ? 0.0 : sorted_quantile(totals, share);
}

void summarise(ExchangeTimes& times) {
    auto& totals = times.totals;
    std::sort(totals.begin(), totals.end());
    times.mean = times.sd = times.standard_error = 0.0;
    if (totals.empty()) return;
    const auto count = static_cast<double>(totals.size());
    times.mean = std::accumulate(totals.begin(), totals.end(), 0.0) / count;
    double squares = 0.0;
    for (const double total : totals)
        squares += (total - times.mean) * (total - times.mean);
    times.sd = count > 1 ? std::sqrt(squares / (count - 1)) : 0.0;
    times.standard_error = times.sd / std::sqrt(count);
}

Interval share_interval(std::size_t part, std::size_t whole) {
    if (whole == 0) return {0.0, 1.0};
    constexpr double kZ = 1.959964;
    const auto n = static_cast<double>(whole);
    const double share = static_cast<double>(part) / n, wide = 1 + kZ * kZ / n;
    const double middle = (share + kZ * kZ / (2 * n)) / wide;
    const double half = kZ / wide * std::sqrt(share * (1 - share) / n + kZ * kZ / (4 * n * n));
    return {std::max(0.0, middle - half), std::min(1.0, middle + half)};
}

std::string exchange_table(const ExchangeTimes& times, std::string_view name) {
    const auto percents = [](std::size_t part, std::size_t whole) {
        const Interval at = share_interval(part, whole);
        return fmt::format("{:.1f} to {:.1f} %", 100 * at.low, 100 * at.high);
    };
    const auto row = [](std::string_view what, const auto& ours, const auto& theirs) {
        return fmt::format("{:<24}{:>18}{:>18}\n", what, ours, theirs);
    };
    const auto seconds = [](double value) { return fmt::format("{:.1f} s", value); };
    std::string text = row("", name, "published");
    text += row("attempts", times.attempts, kPublishedAttempts);
    text += row("not found in inquiry", times.not_found, kPublishedNotFound);
    text += row("failed afterwards", times.failed_later, 0);
    text += row("failures", fmt::format("{:.1f} %", times.failed_percent()),
                fmt::format("{:.1f} %", 100.0 * kPublishedNotFound / kPublishedAttempts));
    text += row("95 % interval", percents(times.failures(), times.attempts),
                percents(kPublishedNotFound, kPublishedAttempts));
    text += row("exchange, mean", seconds(times.mean), seconds(kPublishedMean));
    text += row("standard deviation", seconds(times.sd), seconds(kPublishedSd));
    const double published_error =
        kPublishedSd / std::sqrt(static_cast<double>(kPublishedAttempts - kPublishedNotFound));
    text += row("standard error of mean", seconds(times.standard_error), seconds(published_error));
    if (times.totals.empty()) return text;
    for (const auto& [what, share] :
         {std::pair{"shortest", 0.0}, {"10 %", 0.1}, {"median", 0.5}, {"90 %", 0.9}, {"longest", 1.0}})
        text += row(what, seconds(times.quantile(share)), "");
    return text;
}

std::string exchange_picture(const ExchangeTimes& times, std::string_view name) {
    constexpr int kLongest = 45;  // s
    constexpr const char *kOurs = "#4878a8", *kPublished = "#b06000";
    std::vector<double> middle, none(kLongest, 0.0), shares = none;
    for (int second = 0; second < kLongest; ++second)
        middle.push_back(second + 0.5);
    for (const double total : times.totals)
        shares[static_cast<std::size_t>(std::clamp(total, 0.0, kLongest - 1.0))] +=
            100.0 / static_cast<double>(times.attempts);
    const double most = std::max(5.0, *std::max_element(shares.begin(), shares.end()));
    Chart chart(fmt::format("{}: {} attempts, {:.1f} +- {:.1f} s, {:.1f} % failed", name, times.attempts,
                            times.mean, times.sd, times.failed_percent()),
                "duration of an exchange, s", "share of attempts, %");
    chart.caption(fmt::format("published: {} attempts, {} +- {} s, {:.1f} % failed", kPublishedAttempts,
                              kPublishedMean, kPublishedSd, 100.0 * kPublishedNotFound / kPublishedAttempts));
    chart.band({kPublishedMean - kPublishedSd, kPublishedMean + kPublishedSd}, {0, 0}, {most, most},
               kPublished);
    chart.bars(middle, 0.45, none, shares, kOurs);
    chart.line({kPublishedMean, kPublishedMean}, {0, most}, kPublished, "published mean and deviation");
    return chart.svg(640, 320);
}

}  // namespace puckloop::tools
