#include "linuxboard/coordinator/gantt.h"

#include "base/pages/chart.h"
#include "base/pages/svg.h"

#include <algorithm>
#include <cmath>
#include <fmt/format.h>
#include <map>

namespace puckloop::coordinator {

namespace {

// Pixels.
constexpr double kLeft = 70, kTop = 50, kWidth = 1100, kRow = 40, kBar = 22, kRobot = 6, kBottom = 60;
constexpr double kLetter = 6.2;  // width of one at 10 px

struct Look {
    const char* activity;
    const char* fill;
};
constexpr Look kLooks[] = {{"free", "#8fce8f"},
                           {"working", "#e07b6a"},
                           {"done", "#e8c870"},
                           {"pause", "#d9d9d9"},
                           {"closed", "#b0b7c3"}};

const char* fill_of(const std::string& activity) {
    for (const Look& look : kLooks)
        if (activity == look.activity) return look.fill;
    return "#ffffff";
}

struct Bar {
    double from = 0, to = 0;
    std::string name, activity;
};
struct Row {
    std::vector<Bar> states, robots;
};

void close(std::vector<Bar>& bars, double time) {
    if (!bars.empty() && bars.back().to < 0) bars.back().to = time;
}

/// What each TAM was when, sorted by name.
std::map<std::string, Row> rows_of(const std::vector<Event>& events, double end) {
    std::map<std::string, Row> rows;
    for (const Event& event : events) {
        if (event.tam.empty()) continue;
        Row& row = rows[event.tam];
        if (event.event == "state") {
            close(row.states, event.time);
            row.states.push_back({event.time, -1, event.value, event.detail});
        } else if (event.event == "robot") {
            close(row.robots, event.time);
            if (event.value == "in") row.robots.push_back({event.time, -1, "robot inside", ""});
        }
    }
    for (auto& [name, row] : rows) {
        close(row.states, end);
        close(row.robots, end);
    }
    return rows;
}

}  // namespace

std::string gantt_svg(const std::vector<Event>& events, const std::string& title) {
    double end = 1e-3;
    for (const Event& event : events)
        end = std::max(end, event.time);
    const std::map<std::string, Row> rows = rows_of(events, end);
    const double height = kTop + kRow * static_cast<double>(rows.size()) + kBottom;
    const double foot = height - kBottom;
    const auto x = [&](double time) { return kLeft + time / end * kWidth; };

    std::string svg = svg_text(kLeft, 24, title, "font-size=\"15\"");
    const double tick = Scale::covering(0, end, 10).step;
    for (double time = 0; time <= end * (1 + 1e-9); time += tick)
        svg += svg_line(x(time), kTop - 6, x(time), foot, "stroke=\"#e4e4e4\"") +
               svg_text(x(time), foot + 16, fmt::format("{:g}", time), "text-anchor=\"middle\"");
    svg += svg_text(kLeft + kWidth + 20, foot + 40, "s since the coordinator began", "text-anchor=\"end\"");
    double y = kTop;
    for (const auto& [name, row] : rows) {
        svg += svg_text(kLeft - 8, y + kBar * 0.7, name, "text-anchor=\"end\"");
        const auto draw = [&](const Bar& bar, double top, double tall, const char* fill) {
            svg += fmt::format("<rect x=\"{:.2f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"{}\" fill=\"{}\">"
                               "<title>{}: {}, {:.2f} s to {:.2f} s</title></rect>\n",
                               x(bar.from), top, x(bar.to) - x(bar.from), tall, fill, escaped(name),
                               escaped(bar.name), bar.from, bar.to);
        };
        for (const Bar& bar : row.states) {
            draw(bar, y, kBar, fill_of(bar.activity));
            if (x(bar.to) - x(bar.from) > kLetter * static_cast<double>(bar.name.size()))
                svg += svg_text(x(bar.from) + 3, y + kBar * 0.65, bar.name, "font-size=\"10\"");
        }
        for (const Bar& bar : row.robots)
            draw(bar, y + kBar + 1, kRobot, "#404a80");
        y += kRow;
    }
    double legend = kLeft;
    const auto entry = [&](const char* fill, const char* name) {
        svg += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"14\" height=\"12\" fill=\"{}\"/>", legend,
                           foot + 30, fill) +
               svg_text(legend + 20, foot + 40, name, "");
        legend += 110;
    };
    for (const Look& look : kLooks)
        entry(look.fill, look.activity);
    entry("#404a80", "robot inside");
    return svg_document(kLeft + kWidth + 30, height, 12, svg);
}

}  // namespace puckloop::coordinator
