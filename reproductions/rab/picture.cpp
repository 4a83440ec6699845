#include "reproductions/rab/picture.h"

#include "base/pages/chart.h"
#include "base/pages/svg.h"
#include "protocols/infrared/rab_reading.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::tools {

namespace {

constexpr double kWidth = 900, kHead = 60, kPanel = 270, kFoot = 24;  // pixels
constexpr double kCentimetresOfMetre = 100;
constexpr double kZ90 = 1.2815516;  // standard normal quantile of 90 %
constexpr const char* kMeasured = "#1f6fb2";
constexpr const char* kPublished = "#c2541b";
constexpr const char* kFaint = "#8a8a8a";
// Of a column's width, from its middle.
constexpr double kLeftSide = -0.2, kRightSide = 0.14, kReadings = 0.26, kReadingsWide = 0.2;

/// One column a distance.
Chart panel(const std::vector<RabSummary>& summary, const char* title, const char* axis) {
    Chart chart(title, "free distance between the robots, cm", axis);
    std::vector<std::string> names;
    for (const RabSummary& s : summary)
        names.push_back(fmt::format("{:g}", s.distance * kCentimetresOfMetre));
    chart.categories(names);
    chart.level(0);
    return chart;
}

/// Published 10, 50 and 90 % of a column, as `scale` makes them of the register's strength.
template <class Scale>
void add_published(Chart& chart, std::size_t column, double distance, const Scale& scale) {
    const auto p = published_at(distance);
    if (!p) return;
    const auto at = [&](double z) { return scale(std::exp(p->log_median + z * p->spread)); };
    chart.interval(static_cast<double>(column) + kLeftSide, at(0), at(-kZ90), at(kZ90), kPublished);
}

void add_measured(Chart& chart, std::size_t column, double low, double median, double high) {
    if (median == 0.0 && low == 0.0 && high == 0.0) return;
    chart.interval(static_cast<double>(column) + kRightSide, median, low, high, kMeasured);
}

/// Every reading as a faint dot, spread over the column's right third; at most some hundreds. A few lie
/// beyond what the panel shows.
void add_readings(Chart& chart, std::size_t column, const std::vector<double>& values, double low,
                  double high) {
    constexpr std::size_t kMost = 160;
    std::vector<double> x, y;
    for (std::size_t i = 0; i < values.size(); i += values.size() / kMost + 1) {
        if (values[i] < low || values[i] > high) continue;
        x.push_back(static_cast<double>(column) + kReadings +
                    kReadingsWide * static_cast<double>(i % 17) / 17);
        y.push_back(values[i]);
    }
    chart.points(x, y, kMeasured, "");
}

std::string strength_panel(const std::vector<RabSummary>& summary) {
    double most = 1000;
    for (const RabSummary& s : summary) {
        most = std::max(most, s.strength.p95);
        if (const auto p = published_at(s.distance))
            most = std::max(most, std::exp(p->log_median + kZ90 * p->spread));
    }
    Chart chart = panel(summary, "strength", "range register");
    for (std::size_t i = 0; i < summary.size(); ++i) {
        const RabSummary& s = summary[i];
        add_readings(chart, i, s.strengths, 0, most);
        add_measured(chart, i, s.strength.p10, s.strength.median, s.strength.p90);
        add_published(chart, i, s.distance, [](double strength) { return strength; });
    }
    return chart.svg(kWidth, kPanel);
}

/// The published formula on both; the dash is the truth.
std::string distance_panel(const std::vector<RabSummary>& summary) {
    Chart chart = panel(summary, "distance computed (dashes: the true one)", "cm");
    for (std::size_t i = 0; i < summary.size(); ++i) {
        const RabSummary& s = summary[i];
        const double middle = static_cast<double>(i), truth = s.distance * kCentimetresOfMetre;
        chart.line({middle - 0.42, middle + 0.42}, {truth, truth}, "#333333", "", true);
        add_measured(chart, i, s.estimate_cm.p10, s.estimate_cm.median, s.estimate_cm.p90);
        add_published(chart, i, s.distance,
                      [](double strength) { return protocols::rab_distance_cm(strength); });
    }
    return chart.svg(kWidth, kPanel);
}

std::string bearing_panel(const std::vector<RabSummary>& summary) {
    double most = 10;
    for (const RabSummary& s : summary)
        most = std::max({most, s.bearing_error.p95, -s.bearing_error.p5});
    most = std::ceil(most / 10) * 10;
    Chart chart = panel(summary, "bearing error", "deg");
    for (std::size_t i = 0; i < summary.size(); ++i) {
        const RabSummary& s = summary[i];
        const Spread& b = s.bearing_error;
        add_readings(chart, i, s.bearing_errors, -most, most);
        const double share =
            s.sent > 0 ? 100.0 * static_cast<double>(s.received) / static_cast<double>(s.sent) : 0;
        chart.text(static_cast<double>(i), -most, fmt::format("{:.0f} % read", share), kFaint, true);
        if (s.received == 0) continue;
        chart.bars({static_cast<double>(i) + kRightSide}, 0.06, {b.p25}, {b.p75}, kMeasured);
        add_measured(chart, i, b.p5, b.median, b.p95);
    }
    return chart.svg(kWidth, kPanel);
}

}  // namespace

std::string rab_picture(const std::vector<RabSummary>& summary, const std::string& caption) {
    std::string body =
        svg_text(16, 26, "Range and bearing of emulated boards", "font-size=\"16\" font-weight=\"bold\"") +
        svg_text(16, 46, caption, "");
    double top = kHead;
    for (const std::string& one :
         {strength_panel(summary), distance_panel(summary), bearing_panel(summary)}) {
        body += svg_moved(0, top, one);
        top += kPanel;
    }
    body += svg_text(16, top + 12, "Published log-normal of real boards: median, 10 to 90 %",
                     fmt::format("fill=\"{}\"", kPublished)) +
            svg_text(420, top + 12, "Emulated: median, 10 to 90 % (bearing: quartiles, 5 to 95 %)",
                     fmt::format("fill=\"{}\"", kMeasured));
    return svg_document(kWidth, top + kFoot, 11, body);
}

}  // namespace puckloop::tools
