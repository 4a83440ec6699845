// The same as a table, rows and a picture.

#include "base/pages/chart.h"
#include "gap/mission/power.h"
#include "gap/stats/rate.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>

namespace puckloop::gap::mission {

namespace {

constexpr double kEnough = 0.8;
constexpr double kWidth = 640, kHeight = 380;  // pixels
constexpr std::array kColours{"#1f618d", "#b03a2e", "#1e8449", "#b9770e", "#6c3483", "#117a65", "#616a6b"};

double share_of(int hits, int of) {
    return rate_of(hits, of).share();
}

std::string name_of(const PowerCurve& curve) {
    return curve.effect.empty() ? "(nothing hidden)" : curve.effect;
}

std::string with_limits(const Rate& rate) {
    return fmt::format("{:.2f} ({:.2f} to {:.2f})", rate.share(), rate.low, rate.high);
}

}  // namespace

std::string power_text(const Power& power) {
    std::string text =
        fmt::format("{} program{}, {} simulated runs, {:g} of a condition's change hidden, {} drawn "
                    "cases each\n\n{:<24} {:>5} {:>22} {:>6} {:>6} {:>6}\n",
                    power.programs, power.programs == 1 ? "" : "s", power.simulated_runs, power.request.share,
                    power.request.cases, "hidden", "runs", "right (95 %)", "wrong", "open", "same");
    for (const PowerCurve& curve : power.curves)
        for (const PowerPoint& point : curve.points)
            text += fmt::format("{:<24} {:>5} {:>22} {:>6.2f} {:>6.2f} {:>6.2f}\n", name_of(curve),
                                point.runs, with_limits(rate_of(point.right, point.cases)),
                                share_of(point.wrong, point.cases), share_of(point.open, point.cases),
                                share_of(point.same, point.cases));
    text += "\n";
    for (const PowerCurve& curve : power.curves) {
        if (curve.effect.empty()) continue;
        const auto enough = std::find_if(curve.points.begin(), curve.points.end(), [](const PowerPoint& p) {
            return share_of(p.right, p.cases) >= kEnough;
        });
        text +=
            enough != curve.points.end()
                ? fmt::format("{}: {} runs of each program name it in 8 of 10\n", curve.effect, enough->runs)
                : fmt::format("{}: {} runs of each program do not name it in 8 of 10\n", curve.effect,
                              curve.points.back().runs);
    }
    return text;
}

std::string power_csv(const Power& power) {
    std::string text = "effect,runs,cases,right,wrong,open,same,right_low,right_high\n";
    for (const PowerCurve& curve : power.curves)
        for (const PowerPoint& point : curve.points) {
            const Rate rate = rate_of(point.right, point.cases);
            text +=
                fmt::format("\"{}\",{},{},{},{},{},{},{:.4f},{:.4f}\n", curve.effect, point.runs, point.cases,
                            point.right, point.wrong, point.open, point.same, rate.low, rate.high);
        }
    return text;
}

std::string power_svg(const Power& power) {
    constexpr double kAside = 0.05;  // effects stand beside each other
    Chart chart(
        fmt::format("what runs of each program show, {:g} of a condition hidden", power.request.share),
        "measured runs of each program", "share rightly called");
    std::vector<std::string> runs;
    for (const std::size_t number : power.request.runs)
        runs.push_back(fmt::format("{}", number));
    for (std::size_t c = 0; c < power.curves.size(); ++c) {
        const PowerCurve& curve = power.curves[c];
        const std::string colour =
            curve.effect.empty() ? kColours.back() : kColours[c % (kColours.size() - 1)];
        std::vector<double> x, y;
        for (std::size_t i = 0; i < curve.points.size(); ++i) {
            const PowerPoint& point = curve.points[i];
            x.push_back(static_cast<double>(i) +
                        kAside *
                            (static_cast<double>(c) - 0.5 * static_cast<double>(power.curves.size() - 1)));
            y.push_back(share_of(point.right, point.cases));
            const Rate rate = rate_of(point.right, point.cases);
            chart.interval(x.back(), y.back(), rate.low, rate.high, colour);
        }
        chart.line(x, y, colour, curve.effect.empty() ? "nothing hidden" : curve.effect,
                   curve.effect.empty());
    }
    chart.categories(runs);
    chart.level(0.0);
    chart.level(1.0);
    chart.caption("bars: 95 % (Clopper and Pearson)");
    return chart.svg(kWidth, kHeight);
}

}  // namespace puckloop::gap::mission
