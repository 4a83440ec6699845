#include "tools/experiments/exchange_times.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::tools {

double ExchangeTimes::failed_percent() const {
    return attempts == 0 ? 0.0 : 100.0 * static_cast<double>(failures()) / static_cast<double>(attempts);
}

double ExchangeTimes::quantile(double share) const {
    if (totals.empty()) return 0.0;
    return totals[static_cast<std::size_t>(share * static_cast<double>(totals.size() - 1) + 0.5)];
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
    constexpr double kWidth = 640, kHeight = 300, kLeft = 50, kBottom = 250, kTop = 40, kRight = 620;
    constexpr int kLongest = 45;  // s
    std::vector<double> shares(kLongest, 0.0);
    for (const double total : times.totals)
        shares[static_cast<std::size_t>(std::clamp(total, 0.0, kLongest - 1.0))] +=
            100.0 / static_cast<double>(times.attempts);
    const double most = std::max(5.0, *std::max_element(shares.begin(), shares.end()));
    const double line = most > 12 ? 5 : 2;  // between the shares that are named
    const auto x = [&](double seconds) { return kLeft + (kRight - kLeft) * seconds / kLongest; };
    const auto y = [&](double share) { return kBottom - (kBottom - kTop) * share / most; };
    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"{0}\" height=\"{1}\" fill=\"white\"/>\n",
        kWidth, kHeight);
    svg += fmt::format("<rect x=\"{:.1f}\" y=\"{}\" width=\"{:.1f}\" height=\"{}\" fill=\"#f3ddb3\"/>\n",
                       x(kPublishedMean - kPublishedSd), kTop, x(2 * kPublishedSd) - x(0), kBottom - kTop);
    for (int second = 0; second < kLongest; ++second)
        svg += fmt::format(
            "<rect x=\"{:.1f}\" y=\"{:.1f}\" width=\"{:.1f}\" height=\"{:.1f}\" fill=\"#4878a8\"/>\n",
            x(second) + 0.5, y(shares[static_cast<std::size_t>(second)]), x(1) - x(0) - 1,
            kBottom - y(shares[static_cast<std::size_t>(second)]));
    svg += fmt::format("<line x1=\"{0:.1f}\" y1=\"{1}\" x2=\"{0:.1f}\" y2=\"{2}\" stroke=\"#b06000\" "
                       "stroke-width=\"2\"/>\n",
                       x(kPublishedMean), kTop, kBottom);
    svg += fmt::format("<line x1=\"{}\" y1=\"{}\" x2=\"{}\" y2=\"{}\" stroke=\"black\"/>\n", kLeft, kBottom,
                       kRight, kBottom);
    for (int second = 0; second <= kLongest; second += 5)
        svg += fmt::format("<text x=\"{:.1f}\" y=\"{}\" text-anchor=\"middle\">{}</text>\n", x(second),
                           kBottom + 16, second);
    for (double share = 0; share <= most; share += line)
        svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:g} %</text>\n", kLeft - 6,
                           y(share) + 4, share);
    svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">duration of an exchange, s</text>\n",
                       (kLeft + kRight) / 2, kBottom + 36);
    svg +=
        fmt::format("<text x=\"{}\" y=\"18\">{}: {} attempts, {:.1f} +- {:.1f} s, {:.1f} % failed</text>\n",
                    kLeft, name, times.attempts, times.mean, times.sd, times.failed_percent());
    svg +=
        fmt::format("<text x=\"{}\" y=\"33\" fill=\"#b06000\">published: {} attempts, {} +- {} s, {:.1f} % "
                    "failed</text>\n",
                    kLeft, kPublishedAttempts, kPublishedMean, kPublishedSd,
                    100.0 * kPublishedNotFound / kPublishedAttempts);
    return svg + "</svg>\n";
}

}  // namespace puckloop::tools
