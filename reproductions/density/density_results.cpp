// What teams of several sizes heard, as table, CSV and picture.

#include "base/pages/chart.h"
#include "reproductions/density/density.h"

#include <fmt/format.h>

#include <algorithm>
#include <array>
#include <map>

namespace puckloop::tools {

namespace {

/// What most frames of a class were lost by.
std::string main_cause(const DensityClass& one) {
    const auto most = std::max_element(one.lost.begin(), one.lost.end());
    return *most == 0 ? "" : std::string(name_of(static_cast<Cause>(most - one.lost.begin())));
}

std::string class_name(std::size_t i) {
    return fmt::format("{:g} to {:g} m", kDensityEdges[i], kDensityEdges[i + 1]);
}

}  // namespace

std::string density_table(const std::vector<DensityRow>& rows) {
    std::string text = fmt::format("{:16} {:>6} {:>5}", "setting", "robots", "bytes");
    for (std::size_t i = 0; i + 1 < kDensityEdges.size(); ++i)
        text += fmt::format(" {:>13}", class_name(i));
    text += fmt::format(" {:>9}  {}\n", "steps", "most are lost by");
    for (const DensityRow& row : rows) {
        text += fmt::format("{:16} {:6} {:5}", row.setting, row.robots, row.bytes);
        for (const DensityClass& one : row.density.classes)
            text += one.frames == 0 ? fmt::format(" {:>13}", "-") : fmt::format(" {:13.3f}", one.share());
        const DensityClass& near = row.density.neighbours;
        text +=
            (near.steps == 0 ? fmt::format(" {:>9}", "-") : fmt::format(" {:9.3f}", near.share_of_steps())) +
            "  " + main_cause(near) + "\n";
    }
    return text +
           fmt::format(
               "share of the frames that arrive, by distance; steps: share of {:g} ms steps in which a "
               "neighbour within {:g} m is heard.\nPublished calibrations: {:g} for two robots, {:g} "
               "for twenty ({:g} in a pseudo-reality).\n",
               kDensityStep * 1e3, kNeighbour, kPublishedOfTwo, kPublishedOfTwenty, kPublishedLow);
}

std::string density_csv(const std::vector<DensityRow>& rows) {
    std::string csv = "setting,robots,bytes,runs,from_m,to_m,frames,heard,steps,steps_heard";
    for (std::size_t i = 0; i < kCauses; ++i)
        csv += fmt::format(",lost_{}", name_of(static_cast<Cause>(i)));
    csv += '\n';
    for (const DensityRow& row : rows)
        for (std::size_t i = 0; i + 1 < kDensityEdges.size(); ++i) {
            const DensityClass& one = row.density.classes[i];
            csv += fmt::format("{},{},{},{},{:g},{:g},{},{},{},{}", row.setting, row.robots, row.bytes,
                               row.runs, kDensityEdges[i], kDensityEdges[i + 1], one.frames, one.heard,
                               one.steps, one.steps_heard);
            for (const std::size_t lost : one.lost)
                csv += fmt::format(",{}", lost);
            csv += '\n';
        }
    return csv;
}

std::string density_picture(const std::vector<DensityRow>& rows, const std::string& caption) {
    constexpr double kWidth = 640, kHeight = 420;
    constexpr std::array<const char*, 6> kColours{"#005aa0", "#c85000", "#008264",
                                                  "#963282", "#aa7800", "#5a5a5a"};
    Chart chart("A neighbour within 0.5 m is heard", "robots", "share of 100 ms steps");
    std::vector<std::pair<std::string, int>> series;
    std::vector<int> payloads;
    for (const DensityRow& row : rows) {
        const std::pair one(row.setting, row.bytes);
        if (std::find(series.begin(), series.end(), one) == series.end()) series.push_back(one);
        if (std::find(payloads.begin(), payloads.end(), row.bytes) == payloads.end())
            payloads.push_back(row.bytes);
    }
    std::string dashed;
    for (const auto& [setting, bytes] : series) {
        std::vector<double> x, y;
        for (const DensityRow& row : rows)
            if (row.setting == setting && row.bytes == bytes && row.density.neighbours.steps > 0) {
                x.push_back(row.robots);
                y.push_back(row.density.neighbours.share_of_steps());
            }
        const auto payload =
            static_cast<std::size_t>(std::find(payloads.begin(), payloads.end(), bytes) - payloads.begin());
        const std::string colour = kColours[payload % kColours.size()];
        const bool first = setting == series.front().first;
        if (!first) dashed = "; dashed: " + setting;
        chart.line(x, y, colour,
                   first ? fmt::format("{} byte{}", bytes, bytes == 1 ? "" : "s") : std::string(), !first);
        chart.dots(x, y, colour);
    }
    chart.caption(caption + dashed);
    chart.level(0.0);
    chart.level(1.0);
    chart.interval(2, kPublishedOfTwo, kPublishedOfTwo, kPublishedOfTwo, "#1d2430", "published");
    chart.interval(20, kPublishedOfTwenty, kPublishedLow, kPublishedOfTwenty, "#1d2430");
    return chart.svg(kWidth, kHeight);
}

}  // namespace puckloop::tools
