#include "base/pages/chart.h"
#include "base/pages/svg.h"
#include "selftest/grammar/curves.h"

#include <fmt/format.h>

#include <cmath>

namespace puckloop::gap::selftest::grammar {

namespace {

constexpr double kWidth = 330, kHeight = 230;  // of a chart, pixels
constexpr Class kShown[] = {Class::Unknown, Class::NearMiss, Class::Known, Class::Null};
constexpr const char* kColours[] = {"#b03a2e", "#b9770e", "#1f618d", "#616a6b"};

/// Share rightly called, a line a class; bands stand beside each other, each class a little aside.
template <class CurveOf>
std::string curves(const char* title, const char* axis, const CurveOf& curve_of, bool nulls,
                   double width = kWidth, double height = kHeight) {
    constexpr double kAside = 0.06;
    Chart chart(title, axis, "share rightly called");
    std::vector<std::string> names;
    for (std::size_t c = 0; c < std::size(kShown); ++c) {
        if (kShown[c] == Class::Null && !nulls) continue;
        std::vector<double> x, y;
        const Curve bands = curve_of(kShown[c]);
        names.clear();
        for (std::size_t b = 0; b < bands.size(); ++b) {
            names.push_back(bands[b].high == bands[b].low ? fmt::format("{:g}", bands[b].low)
                            : bands[b].high < 100 ? fmt::format("{:g} to {:g}", bands[b].low, bands[b].high)
                                                  : fmt::format("from {:g}", bands[b].low));
            if (bands[b].of == 0) continue;
            const Rate rate = rate_of(bands[b].right, bands[b].of);
            x.push_back(static_cast<double>(b) + kAside * (static_cast<double>(c) - 1));
            y.push_back(rate.share());
            chart.interval(x.back(), rate.share(), rate.low, rate.high, kColours[c]);
        }
        if (!x.empty()) chart.line(x, y, kColours[c], class_name(kShown[c]));
    }
    chart.categories(names);
    chart.level(1.0);
    chart.level(0.0);
    return chart.svg(width, height);
}

std::string ranks(const std::vector<Outcome>& cases) {
    Chart chart("ranks of true parameters", "rank in what is said of them", "parameters");
    const auto histogram = rank_histogram(cases);
    double all = 0.0;
    for (std::size_t bin = 0; bin < histogram.size(); ++bin) {
        const double at = (static_cast<double>(bin) + 0.5) / 10;
        chart.interval(at, histogram[bin], 0, histogram[bin], kColours[2]);
        all += histogram[bin];
    }
    chart.level(all / 10, "honest");
    return chart.svg(kWidth, kHeight);
}

}  // namespace

std::string power_svg(const std::vector<Outcome>& cases) {
    constexpr double kWide = 520, kHigh = 320;
    return curves(
        "power of drawn cases, all strengths (95 % binomial intervals)", "runs that were analysed",
        [&](Class of) { return power(cases, of); }, true, kWide, kHigh);
}

std::string curves_svg(const std::vector<Outcome>& cases) {
    const std::string charts[] = {
        curves(
            "sensitivity", "strength over noise", [&](Class of) { return by_strength(cases, of); }, false),
        curves(
            "power, strength 1 and above", "runs", [&](Class of) { return by_runs(cases, of); }, true),
        ranks(cases)};
    std::string body;
    for (std::size_t k = 0; k < std::size(charts); ++k)
        body += svg_moved(static_cast<double>(k) * kWidth, 0, charts[k]);
    return svg_document(3 * kWidth, kHeight, 10, body);
}

}  // namespace puckloop::gap::selftest::grammar
