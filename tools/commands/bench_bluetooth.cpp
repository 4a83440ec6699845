// `puckloop bench bluetooth`: how long exchanges between two Bluetooth modules take and how often they fail,
// beside what was published.

#include "tools/commands/bench_bluetooth.h"
#include "base/error.h"
#include "emu/bluetooth/exchange.h"
#include "tools/cli/check.h"
#include "tools/cli/command.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>
#include <filesystem>
#include <fstream>
#include <memory>
#include <string>
#include <vector>

namespace puckloop::tools {

namespace {

using bluetooth::Exchange;

// Couceiro et al. 2014.
constexpr double kPublishedMean = 19.8, kPublishedSd = 4.5;  // s
constexpr int kPublishedAttempts = 58, kPublishedFound = 53;

struct Options {
    unsigned exchanges = 1000;
    std::uint64_t seed = 1;
    std::filesystem::path out = "out/bluetooth_times";
};

struct Summary {
    std::size_t attempts = 0, found = 0, arrived = 0;
    double mean = 0.0, sd = 0.0;
    std::vector<double> totals{};  ///< of those that arrived, rising
};

Summary summarise(const std::vector<Exchange>& exchanges) {
    Summary summary;
    summary.attempts = exchanges.size();
    double sum = 0.0, squares = 0.0;
    for (const Exchange& one : exchanges) {
        summary.found += one.found ? 1 : 0;
        if (!one.arrived) continue;
        ++summary.arrived;
        summary.totals.push_back(one.total);
        sum += one.total;
    }
    if (summary.totals.empty()) return summary;
    const auto count = static_cast<double>(summary.totals.size());
    summary.mean = sum / count;
    for (const double total : summary.totals)
        squares += (total - summary.mean) * (total - summary.mean);
    summary.sd = count > 1 ? std::sqrt(squares / (count - 1)) : 0.0;
    std::sort(summary.totals.begin(), summary.totals.end());
    return summary;
}

std::string text(const Summary& summary) {
    const auto percent = [](double part, double whole) { return 100 * part / whole; };
    const double failed = percent(static_cast<double>(summary.attempts - summary.arrived),
                                  static_cast<double>(summary.attempts));
    std::string lines = fmt::format("{:<22}{:>12}{:>12}\n", "", "drawn", "published");
    lines += fmt::format("{:<22}{:>12}{:>12}\n", "attempts", summary.attempts, kPublishedAttempts);
    lines += fmt::format("{:<22}{:>12}{:>12}\n", "not found in inquiry", summary.attempts - summary.found,
                         kPublishedAttempts - kPublishedFound);
    lines += fmt::format("{:<22}{:>12}{:>12}\n", "failed afterwards", summary.found - summary.arrived, 0);
    lines += fmt::format("{:<22}{:>11.1f}%{:>11.1f}%\n", "failures", failed,
                         percent(kPublishedAttempts - kPublishedFound, kPublishedAttempts));
    lines += fmt::format("{:<22}{:>10.1f} s{:>10.1f} s\n", "exchange, mean", summary.mean, kPublishedMean);
    lines += fmt::format("{:<22}{:>10.1f} s{:>10.1f} s\n", "standard deviation", summary.sd, kPublishedSd);
    if (!summary.totals.empty())
        lines += fmt::format("{:<22}{:>10.1f} s\n{:<22}{:>10.1f} s\n", "shortest", summary.totals.front(),
                             "longest", summary.totals.back());
    return lines;
}

/// Exchanges a second of their duration, with the published mean and deviation; failures beside them.
std::string picture(const Summary& summary) {
    constexpr double kWidth = 640, kHeight = 300, kLeft = 50, kBottom = 250, kTop = 40, kRight = 620;
    constexpr int kLongest = 45;  // s
    std::vector<double> shares(kLongest, 0.0);
    for (const double total : summary.totals)
        shares[static_cast<std::size_t>(std::clamp(total, 0.0, kLongest - 1.0))] +=
            100.0 / static_cast<double>(summary.attempts);
    const double most = std::max(5.0, *std::max_element(shares.begin(), shares.end()));
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
    for (double share = 0; share <= most; share += 2)
        svg += fmt::format("<text x=\"{}\" y=\"{:.1f}\" text-anchor=\"end\">{:g} %</text>\n", kLeft - 6,
                           y(share) + 4, share);
    svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"middle\">duration of an exchange, s</text>\n",
                       (kLeft + kRight) / 2, kBottom + 36);
    svg += fmt::format(
        "<text x=\"{}\" y=\"18\">drawn: {} attempts, {:.1f} +- {:.1f} s, {:.1f} % failed</text>\n", kLeft,
        summary.attempts, summary.mean, summary.sd,
        100.0 * static_cast<double>(summary.attempts - summary.arrived) /
            static_cast<double>(summary.attempts));
    svg +=
        fmt::format("<text x=\"{}\" y=\"33\" fill=\"#b06000\">published: {} attempts, {} +- {} s, {:.1f} % "
                    "failed</text>\n",
                    kLeft, kPublishedAttempts, kPublishedMean, kPublishedSd,
                    100.0 * (kPublishedAttempts - kPublishedFound) / kPublishedAttempts);
    return svg + "</svg>\n";
}

std::string csv(const std::vector<Exchange>& exchanges) {
    std::string rows = "exchange,found,linked,arrived,inquiry_s,name_s,link_s,release_s,total_s\n";
    for (std::size_t i = 0; i < exchanges.size(); ++i) {
        const Exchange& one = exchanges[i];
        rows += fmt::format("{},{},{},{},{:.3f},{:.3f},{:.3f},{:.3f},{:.3f}\n", i, one.found ? 1 : 0,
                            one.linked ? 1 : 0, one.arrived ? 1 : 0, one.inquiry, one.name, one.link,
                            one.release, one.total);
    }
    return rows;
}

void save(const std::filesystem::path& file, const std::string& content) {
    std::ofstream stream(file);
    stream << content;
    stream.close();
    if (!stream) throw RunError(fmt::format("cannot write {}", file.string()));
}

void run(const Options& options, int& status) {
    std::error_code failed;
    std::filesystem::create_directories(options.out, failed);
    if (failed) throw RunError(fmt::format("cannot make {}: {}", options.out.string(), failed.message()));
    std::vector<Exchange> exchanges;
    exchanges.reserve(options.exchanges);
    for (unsigned i = 0; i < options.exchanges; ++i)
        exchanges.push_back(bluetooth::exchange({}, options.seed, i));
    const Summary summary = summarise(exchanges);
    save(options.out / "exchanges.csv", csv(exchanges));
    save(options.out / "exchanges.svg", picture(summary));
    fmt::print("{}{}\n", text(summary), (options.out / "exchanges.svg").string());
    status = 0;
}

}  // namespace

void declare_bench_bluetooth(Command& bench, int& status) {
    Command* command = bench.add_subcommand(
        "bluetooth", "how long exchanges by Bluetooth take and how often they fail, as picture and table");
    auto options = std::make_shared<Options>();
    command->add_option("--exchanges", options->exchanges, "between two modules, each from power-up")
        ->check(whole_number_between(1, 1'000'000))
        ->type_name("N");
    command->add_option("--seed", options->seed, "of what is drawn")
        ->check(count_up_to(1'000'000'000))
        ->type_name("N");
    command->add_option("--out", options->out, "folder for the results")->type_name("DIR");
    command->callback([options, &status] { run(*options, status); });
}

}  // namespace puckloop::tools
