#include "reproductions/pictures.h"

#include "base/pages/chart.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace puckloop::tools {

namespace {

constexpr const char* kMeasured = "#1f6fb2";
constexpr const char* kPath = "#b5b5b5";
constexpr const char* kFailed = "#c0392b";
constexpr const char* kPublished = "#c2541b";
constexpr const char* kWords = "#555555";
constexpr double kWide = 800, kHigh = 440, kSquare = 540;  // pixels
constexpr double kHeardAt = 60;                            // counts: the publication's threshold
constexpr std::array<const char*, kCalls> kCallNames{"haa", "spaah", "ouah", "yaouh", "wouaaaaaaaah"};

/// Decile band and median of `bins`, `scale` times their places, and the publication's threshold.
Chart volumes(const std::vector<Bin>& bins, double scale, const char* title, const char* axis,
              const std::string& caption) {
    std::vector<double> at, low, middle, high;
    for (const Bin& bin : bins) {
        at.push_back(bin.at * scale);
        low.push_back(bin.p10);
        middle.push_back(bin.median);
        high.push_back(bin.p90);
    }
    Chart chart(title, axis, "mean of three volumes, counts");
    chart.caption(caption);
    chart.band(at, low, high, kMeasured);
    chart.line(at, middle, kMeasured, "median and deciles");
    chart.level(0);
    chart.level(kHeardAt, "heard (published threshold)");
    return chart;
}

double highest(const std::vector<Bin>& bins) {
    double high = 2 * kHeardAt;
    for (const Bin& bin : bins)
        high = std::max(high, bin.p90);
    return high;
}

}  // namespace

std::string distance_picture(const Readings& readings, const std::string& caption) {
    const auto bins = binned(readings, 0.005);
    Chart chart = volumes(bins, 1000, "Sound 1 against distance", "between the robots' centres, mm", caption);
    chart.line({200, 200}, {0, highest(bins)}, kPublished, "published up to 200 mm: motors are louder", true);
    return chart.svg(kWide, kHigh);
}

std::string calls_picture(const Readings& readings, const std::string& caption) {
    const auto bins = binned(readings, 0.03);
    Chart chart = volumes(bins, 1, "Five sounds in a row, robots 10 cm apart", "time, s", caption);
    for (std::size_t call = 0; call < kCalls; ++call) {
        const double from = kFirstCall + static_cast<double>(call) * kCallSpacing;
        chart.text(from, highest(bins), kCallNames[call], kWords);
        chart.line({from, from + kCallWords[call] / kCallRate}, {1, 1}, kWords, "");
    }
    return chart.svg(kWide, kHigh);
}

std::string ears_picture(const Ears& ears, const std::string& caption, const std::vector<Heard>& failed) {
    Chart chart("Ears and radio: where it heard", "x, mm", "y, mm");
    chart.caption(caption);
    chart.equal_axes();
    std::vector<double> path_x, path_y, heard_x, heard_y, failed_x, failed_y;
    std::vector<std::pair<double, double>> places;
    for (const auto& point : ears.path)
        path_x.push_back(1000 * point.x), path_y.push_back(1000 * point.y);
    for (const Heard& one : ears.heard) {
        heard_x.push_back(1000 * one.x), heard_y.push_back(1000 * one.y);
        places.emplace_back(one.x, one.y);
    }
    for (const Heard& one : failed)
        failed_x.push_back(1000 * one.x), failed_y.push_back(1000 * one.y);
    chart.line(path_x, path_y, kPath, "path");
    chart.interval(0, 0, 0, 0, kPublished, "caller");
    chart.dots(heard_x, heard_y, kMeasured, "heard");
    chart.dots(failed_x, failed_y, kFailed, failed.empty() ? "" : "message failed: nobody found");
    if (const auto fit = fit_ellipse(places)) {
        constexpr int kCorners = 72;
        std::vector<double> x, y;
        for (int i = 0; i <= kCorners; ++i) {
            const double turn = 2 * std::numbers::pi * i / kCorners;
            const double a = fit->major * std::cos(turn), b = fit->minor * std::sin(turn);
            x.push_back(1000 * (fit->x + a * std::cos(fit->angle) - b * std::sin(fit->angle)));
            y.push_back(1000 * (fit->y + a * std::sin(fit->angle) + b * std::cos(fit->angle)));
        }
        chart.line(x, y, kPublished, "");
    }
    return chart.svg(kSquare, kSquare);
}

std::string readings_csv(const Readings& readings, const std::string& at) {
    std::string csv = fmt::format("trial,{},right,left,rear\n", at);
    for (std::size_t trial = 0; trial < readings.size(); ++trial)
        for (const Volumes& one : readings[trial])
            csv += fmt::format("{},{:.4f},{:g},{:g},{:g}\n", trial, one.at, one.counts[0], one.counts[1],
                               one.counts[2]);
    return csv;
}

std::string heard_csv(const Ears& ears) {
    std::string csv = "t_s,x_m,y_m\n";
    for (const Heard& one : ears.heard)
        csv += fmt::format("{:.3f},{:.4f},{:.4f}\n", one.seconds, one.x, one.y);
    return csv;
}

}  // namespace puckloop::tools
