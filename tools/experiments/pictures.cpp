#include "tools/experiments/pictures.h"

#include "tools/experiments/chart.h"

#include <fmt/format.h>

#include <array>
#include <cmath>
#include <numbers>

namespace puckloop::tools {

namespace {

constexpr const char* kMeasured = "#1f6fb2";
constexpr const char* kPath = "#b5b5b5";
constexpr const char* kFailed = "#c0392b";
constexpr double kHeardAt = 60;  // counts: the publication's threshold
constexpr std::array<const char*, kCalls> kCallNames{"haa", "spaah", "ouah", "yaouh", "wouaaaaaaaah"};

/// Decile band and median of `bins`, `scale` times their places.
void draw(Chart& chart, const std::vector<Bin>& bins, double scale) {
    Chart::Points low, middle, high;
    for (const Bin& bin : bins) {
        low.emplace_back(bin.at * scale, bin.p10);
        middle.emplace_back(bin.at * scale, bin.median);
        high.emplace_back(bin.at * scale, bin.p90);
    }
    chart.band(low, high, kMeasured);
    chart.line(middle, kMeasured);
}

double ceiling(const std::vector<Bin>& bins, double step) {
    double high = 2 * kHeardAt;
    for (const Bin& bin : bins)
        high = std::max(high, bin.p90);
    return std::ceil(high / step) * step;
}

}  // namespace

std::string distance_picture(const Readings& readings, const std::string& caption) {
    const auto bins = binned(readings, 0.005);
    Chart chart("Sound 1 against distance", caption, {70, 310, 20, "between the robots' centres, mm"},
                {0, ceiling(bins, 20), 20, "mean of three volumes, counts"});
    draw(chart, bins, 1000);
    chart.level(kHeardAt, "heard (published threshold)");
    chart.line({{200, 0}, {200, ceiling(bins, 20)}}, "#c2541b", "stroke-dasharray=\"5 4\"");
    chart.text(202, 4, "published up to 200 mm: motors are louder", "fill=\"#c2541b\" font-size=\"10\"");
    return chart.document();
}

std::string calls_picture(const Readings& readings, const std::string& caption) {
    const auto bins = binned(readings, 0.03);
    const double high = ceiling(bins, 20);
    Chart chart("Five sounds in a row, robots 10 cm apart", caption,
                {0, kFirstCall + kCalls * kCallSpacing, 1, "time, s"},
                {0, high, 20, "mean of three volumes, counts"});
    draw(chart, bins, 1);
    chart.level(kHeardAt, "heard (published threshold)");
    for (std::size_t call = 0; call < kCalls; ++call) {
        const double from = kFirstCall + static_cast<double>(call) * kCallSpacing;
        chart.text(from, high * 0.96, kCallNames[call], "fill=\"#555\" font-size=\"11\"");
        chart.line({{from, 1}, {from + kCallWords[call] / kCallRate, 1}}, "#555");
    }
    return chart.document();
}

std::string ears_picture(const Ears& ears, const std::string& caption, const std::vector<Heard>& failed) {
    Chart chart("Ears and radio: where it heard", caption, {-300, 300, 100, "x, mm"},
                {-300, 300, 100, "y, mm"}, true);
    Chart::Points path, heard, ellipse;
    std::vector<std::pair<double, double>> places;
    for (const auto& point : ears.path)
        path.emplace_back(1000 * point.x, 1000 * point.y);
    for (const Heard& one : ears.heard) {
        heard.emplace_back(1000 * one.x, 1000 * one.y);
        places.emplace_back(one.x, one.y);
    }
    chart.line(path, kPath, "stroke-opacity=\"0.6\"");
    chart.dots({{0, 0}}, "#c2541b", 9);
    chart.dots(heard, kMeasured, 3.5);
    for (const Heard& one : failed)
        chart.dots({{1000 * one.x, 1000 * one.y}}, kFailed, 3.5);
    if (!failed.empty())
        chart.text(-290, 275, "message failed: nobody found",
                   fmt::format("fill=\"{}\" font-size=\"11\"", kFailed));
    if (const auto fit = fit_ellipse(places)) {
        constexpr int kCorners = 72;
        for (int i = 0; i <= kCorners; ++i) {
            const double turn = 2 * std::numbers::pi * i / kCorners;
            const double a = fit->major * std::cos(turn), b = fit->minor * std::sin(turn);
            ellipse.emplace_back(1000 * (fit->x + a * std::cos(fit->angle) - b * std::sin(fit->angle)),
                                 1000 * (fit->y + a * std::sin(fit->angle) + b * std::cos(fit->angle)));
        }
        chart.line(ellipse, "#c2541b");
    }
    return chart.document();
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
