#include "reproductions/pause_times.h"

#include "base/pages/chart.h"
#include "base/quantile.h"

#include <fmt/format.h>

#include <numeric>
#include <utility>

namespace puckloop::tools {

namespace {

constexpr double kMilliseconds = 1000;

Pause pause_of(const TeamMessage& message, std::size_t to) {
    const Arrival& at = message.arrivals[to];
    Pause pause{message.from, to, message.begun};
    if (at.received < 0) return pause;
    pause.pause = kMilliseconds * (at.received - message.begun);
    // A line that came in several segments was nowhere whole: its parts are not known apart.
    const double passed = at.passed < 0 ? message.ended : at.passed;
    const double arrived = at.arrived < 0 ? passed : at.arrived;
    pause.parts = {kMilliseconds * (message.ended - message.begun), kMilliseconds * (passed - message.ended),
                   kMilliseconds * (arrived - passed), kMilliseconds * (at.received - arrived)};
    return pause;
}

}  // namespace

std::vector<Pause> pauses_of(const std::vector<TeamMessage>& messages, double from, double until) {
    std::vector<Pause> pauses;
    for (const TeamMessage& message : messages) {
        if (message.begun < from || message.begun >= until) continue;
        for (std::size_t to = 0; to < message.arrivals.size(); ++to)
            if (to != message.from) pauses.push_back(pause_of(message, to));
    }
    return pauses;
}

TeamPauses summary_of(int robots, int runs, const std::vector<Pause>& pauses) {
    TeamPauses team{robots, runs, pauses.size()};
    std::vector<double> times;
    for (const Pause& one : pauses) {
        if (one.pause < 0) {
            ++team.lost;
            continue;
        }
        times.push_back(one.pause);
        for (std::size_t part = 0; part < team.parts.size(); ++part)
            team.parts[part] += one.parts[part];
    }
    if (times.empty()) return team;
    const auto count = static_cast<double>(times.size());
    for (double& part : team.parts)
        part /= count;
    team.mean = std::accumulate(times.begin(), times.end(), 0.0) / count;
    team.low = quantile(times, 0.05);
    team.quarter = quantile(times, 0.25);
    team.median = quantile(times, 0.5);
    team.three_quarters = quantile(times, 0.75);
    team.high = quantile(times, 0.95);
    return team;
}

double published_pause(int robots) {
    return kPublishedPauseOf2 + (kPublishedPauseOf14 - kPublishedPauseOf2) * (robots - kFewestInTeam) /
                                    (kMostInTeam - kFewestInTeam);
}

double growth_of(const std::vector<TeamPauses>& teams) {
    double x = 0, y = 0, count = 0;
    for (const TeamPauses& team : teams)
        x += team.robots, y += team.median, ++count;
    if (count == 0) return 0;
    x /= count, y /= count;
    double product = 0, square = 0;
    for (const TeamPauses& team : teams) {
        product += (team.robots - x) * (team.median - y);
        square += (team.robots - x) * (team.robots - x);
    }
    return square == 0 ? 0 : product / square;
}

std::string pause_table(const PauseSeries& series) {
    const std::vector<TeamPauses>& teams = series.teams;
    std::string text = fmt::format("{}\n{:>6} {:>5} {:>8} {:>6} {:>8} {:>8} {:>8} {:>8} {:>8} {:>10}\n",
                                   series.forwarder, "robots", "runs", "packets", "lost", "5 %", "25 %",
                                   "median", "75 %", "95 %", "published");
    std::size_t packets = 0, lost = 0;
    for (const TeamPauses& team : teams) {
        text += fmt::format("{:6} {:5} {:8} {:6} {:8.1f} {:8.1f} {:8.1f} {:8.1f} {:8.1f} {:10.0f}\n",
                            team.robots, team.runs, team.packets, team.lost, team.low, team.quarter,
                            team.median, team.three_quarters, team.high, published_pause(team.robots));
        packets += team.packets;
        lost += team.lost;
    }
    text += fmt::format("times in ms; {} of {} packets lost (published: 0 of {})\n", lost, packets,
                        kPublishedPackets);
    if (teams.size() > 1)
        text += fmt::format("each further robot adds {:.2f} ms to the median (published: {:.2f} ms)\n",
                            growth_of(teams),
                            (kPublishedPauseOf14 - kPublishedPauseOf2) / (kMostInTeam - kFewestInTeam));
    text += "mean, and its parts:";
    for (const char* part : kPauseParts)
        text += fmt::format(" | {}", part);
    text += '\n';
    for (const TeamPauses& team : teams) {
        text += fmt::format("{:6} {:8.2f} =", team.robots, team.mean);
        for (std::size_t part = 0; part < team.parts.size(); ++part)
            text += fmt::format("{}{:.2f}", part == 0 ? " " : " + ", team.parts[part]);
        text += '\n';
    }
    return text;
}

namespace {

/// One forwarder's boxes, `shift` beside the team's size.
void draw_boxes(Chart& chart, const PauseSeries& series, double shift, double half, const char* colour,
                const char* dark) {
    std::vector<double> at, quarter, three_quarters;
    for (const TeamPauses& team : series.teams) {
        const double x = team.robots + shift;
        at.push_back(x);
        quarter.push_back(team.quarter);
        three_quarters.push_back(team.three_quarters);
        chart.line({x, x}, {team.low, team.high}, colour, "");
    }
    chart.bars(at, half, quarter, three_quarters, colour);
    bool first = true;
    for (std::size_t i = 0; i < at.size(); ++i) {
        chart.line({at[i] - half, at[i] + half}, {series.teams[i].median, series.teams[i].median}, dark,
                   first ? series.forwarder : std::string());
        first = false;
    }
}

}  // namespace

std::string pause_picture(const std::vector<PauseSeries>& series, const std::string& caption) {
    constexpr const char* kPublished = "#b06000";
    constexpr std::array<std::pair<const char*, const char*>, 2> kColours{
        {{"#8fb4d8", "#1d3f63"}, {"#9cc99c", "#1f5a1f"}}};
    constexpr double kWide = 760, kHigh = 420, kBoxes = 0.7;  // of the room between two sizes
    Chart chart("Pause time of teams that talk by WiFi", "robots in the team", "pause time, ms");
    chart.caption(caption);
    chart.level(0);
    const auto count = static_cast<double>(series.size());
    for (std::size_t i = 0; i < series.size(); ++i) {
        const auto& [colour, dark] = kColours[i % kColours.size()];
        const double shift = kBoxes * ((static_cast<double>(i) + 0.5) / count - 0.5);
        draw_boxes(chart, series[i], shift, kBoxes / count / 2.4, colour, dark);
    }
    std::vector<double> at, published;
    for (const PauseSeries& one : series)
        for (const TeamPauses& team : one.teams)
            if (at.empty() || team.robots > at.back()) {
                at.push_back(team.robots);
                published.push_back(published_pause(team.robots));
            }
    chart.line(at, published, kPublished, "published medians", true);
    chart.dots(at, published, kPublished);
    return chart.svg(kWide, kHigh);
}

std::string pauses_csv_head() {
    return "forwarder,robots,run,from,to,begun_s,pause_ms,uart_out_ms,to_manager_ms,radio_ms,uart_in_ms\n";
}

std::string pauses_csv(const std::string& forwarder, int robots, int run, const std::vector<Pause>& pauses) {
    std::string rows;
    for (const Pause& one : pauses) {
        rows += fmt::format("{},{},{},{},{},{:.6f},", forwarder, robots, run, one.from + 1, one.to + 1,
                            one.begun);
        if (one.pause < 0)
            rows += "lost,,,,\n";
        else
            rows += fmt::format("{:.4f},{:.4f},{:.4f},{:.4f},{:.4f}\n", one.pause, one.parts[0], one.parts[1],
                                one.parts[2], one.parts[3]);
    }
    return rows;
}

}  // namespace puckloop::tools
