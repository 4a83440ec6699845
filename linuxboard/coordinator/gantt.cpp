#include "linuxboard/coordinator/gantt.h"

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

std::string escaped(const std::string& text) {
    std::string out;
    for (const char c : text)
        switch (c) {
        case '&':
            out += "&amp;";
            break;
        case '<':
            out += "&lt;";
            break;
        case '>':
            out += "&gt;";
            break;
        default:
            out += c;
        }
    return out;
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

/// A round number of seconds, such that about ten of them are `span`.
double tick_of(double span) {
    const double decade = std::pow(10, std::floor(std::log10(span / 10)));
    for (const double factor : {1.0, 2.0, 5.0})
        if (span / (decade * factor) <= 12) return decade * factor;
    return decade * 10;
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

    std::string svg = fmt::format(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" width=\"{0}\" height=\"{1}\" viewBox=\"0 0 {0} {1}\" "
        "font-family=\"sans-serif\" font-size=\"12\">\n<rect width=\"100%\" height=\"100%\" "
        "fill=\"#ffffff\"/>\n<text x=\"{2}\" y=\"24\" font-size=\"15\">{3}</text>\n",
        kLeft + kWidth + 30, height, kLeft, escaped(title));
    const double tick = tick_of(end);
    for (double time = 0; time <= end * (1 + 1e-9); time += tick)
        svg +=
            fmt::format("<line x1=\"{0:.2f}\" y1=\"{1}\" x2=\"{0:.2f}\" y2=\"{2}\" stroke=\"#e4e4e4\"/>"
                        "<text x=\"{0:.2f}\" y=\"{3}\" text-anchor=\"middle\" fill=\"#555\">{4:g}</text>\n",
                        x(time), kTop - 6, foot, foot + 16, time);
    svg += fmt::format(
        "<text x=\"{}\" y=\"{}\" text-anchor=\"end\" fill=\"#555\">s since the coordinator began</text>\n",
        kLeft + kWidth + 20, foot + 40);
    double y = kTop;
    for (const auto& [name, row] : rows) {
        svg += fmt::format("<text x=\"{}\" y=\"{}\" text-anchor=\"end\">{}</text>\n", kLeft - 8,
                           y + kBar * 0.7, escaped(name));
        const auto draw = [&](const Bar& bar, double top, double tall, const char* fill) {
            svg += fmt::format("<rect x=\"{:.2f}\" y=\"{:.1f}\" width=\"{:.2f}\" height=\"{}\" fill=\"{}\">"
                               "<title>{}: {}, {:.2f} s to {:.2f} s</title></rect>\n",
                               x(bar.from), top, x(bar.to) - x(bar.from), tall, fill, escaped(name),
                               escaped(bar.name), bar.from, bar.to);
        };
        for (const Bar& bar : row.states) {
            draw(bar, y, kBar, fill_of(bar.activity));
            if (x(bar.to) - x(bar.from) > kLetter * static_cast<double>(bar.name.size()))
                svg += fmt::format("<text x=\"{:.2f}\" y=\"{:.1f}\" font-size=\"10\">{}</text>\n",
                                   x(bar.from) + 3, y + kBar * 0.65, escaped(bar.name));
        }
        for (const Bar& bar : row.robots)
            draw(bar, y + kBar + 1, kRobot, "#404a80");
        y += kRow;
    }
    double legend = kLeft;
    const auto entry = [&](const char* fill, const char* name) {
        svg += fmt::format("<rect x=\"{}\" y=\"{}\" width=\"14\" height=\"12\" fill=\"{}\"/><text x=\"{}\" "
                           "y=\"{}\">{}</text>\n",
                           legend, foot + 30, fill, legend + 20, foot + 40, name);
        legend += 110;
    };
    for (const Look& look : kLooks)
        entry(look.fill, look.activity);
    entry("#404a80", "robot inside");
    return svg + "</svg>\n";
}

}  // namespace puckloop::coordinator
