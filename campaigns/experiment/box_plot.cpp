#include "campaigns/experiment/box_plot.h"

#include "base/pages/chart.h"
#include "base/quantile.h"

#include <algorithm>
#include <iterator>

namespace puckloop::swarm {

namespace {

constexpr double kHalf = 0.28;  // of a box's width; boxes are 1 apart
constexpr double kReach = 1.5;
constexpr double kHeight = 340, kMargin = 120, kEach = 110;  // pixels
constexpr const char *kBox = "#9cc3e6", *kLine = "#1f4e79";

}  // namespace

std::string box_plot(const std::string& title, const std::string& axis,
                     const std::vector<std::pair<std::string, std::vector<double>>>& samples) {
    Chart chart(title, "", axis);
    std::vector<std::string> names;
    for (std::size_t i = 0; i < samples.size(); ++i) {
        const auto x = static_cast<double>(i);
        names.push_back(samples[i].first);
        std::vector<double> sorted = samples[i].second;
        if (sorted.empty()) continue;
        std::sort(sorted.begin(), sorted.end());
        const double low = sorted_quantile(sorted, 0.25), middle = sorted_quantile(sorted, 0.5),
                     high = sorted_quantile(sorted, 0.75), reach = kReach * (high - low);
        const double bottom = *std::lower_bound(sorted.begin(), sorted.end(), low - reach),
                     top = *std::prev(std::upper_bound(sorted.begin(), sorted.end(), high + reach));
        chart.line({x, x}, {bottom, low}, kLine, "");
        chart.line({x, x}, {high, top}, kLine, "");
        chart.bars({x}, kHalf, {low}, {high}, kBox);
        for (const double level : {low, middle, high})
            chart.line({x - kHalf, x + kHalf}, {level, level}, kLine, "");
        for (const double level : {bottom, top})
            chart.line({x - kHalf / 2, x + kHalf / 2}, {level, level}, kLine, "");
        std::vector<double> beyond;
        for (const double value : sorted)
            if (value < bottom || value > top) beyond.push_back(value);
        chart.dots(std::vector<double>(beyond.size(), x), beyond, kLine);
    }
    chart.categories(std::move(names));
    return chart.svg(kMargin + kEach * static_cast<double>(std::max<std::size_t>(samples.size(), 2)),
                     kHeight);
}

}  // namespace puckloop::swarm
