// The booths of TAMs: walls, and over their back what colour they showed, from the run's start on the left
// (seen from the opening) to its end.

#include "physics/render/run_picture.h"

#include <fmt/format.h>

#include <algorithm>
#include <cmath>

namespace puckloop::physics {

namespace {

/// As bright as the screen can show it: LEDs dimmed to a tenth are to be distinguished, too.
std::string shown(const BoothColour& colour) {
    const double most = std::max({colour.red, colour.green, colour.blue});
    if (most <= 0.0) return "#d8d4cc";
    constexpr double kFull = 235.0;
    const auto part = [&](double value) { return static_cast<int>(std::lround(kFull * value / most)); };
    return fmt::format("#{:02x}{:02x}{:02x}", part(colour.red), part(colour.green), part(colour.blue));
}

}  // namespace

void Picture::booth(const Booth& booth, double end) {
    const auto parts = shapes_of(booth);
    for (std::size_t i = 0; i < parts.size(); ++i)
        canvas_.shape(parts[i], i < 3 ? "fill=\"#eeebe4\" stroke=\"#9a958a\" stroke-width=\"1\""
                                      : "fill=\"#dcd7cb\" stroke=\"none\"");
    const auto history = std::find_if(booths_.begin(), booths_.end(),
                                      [&](const BoothColours& one) { return one.name == booth.name; });
    if (history != booths_.end() && end > 0.0) {
        constexpr double kHalf = booth::kSize / 2, kEdge = 0.003;  // m
        const double inside = kHalf - booth::kShell - kEdge;
        const auto& colours = history->colours;
        for (std::size_t i = 0; i < colours.size(); ++i) {
            const double until = i + 1 < colours.size() ? colours[i + 1].seconds : end;
            const double from = colours[i].seconds / end, to = std::min(until / end, 1.0);
            if (to <= from) continue;
            const auto at = [&](double x, double share) {
                return from_booth(booth, x, -inside + 2 * inside * share);
            };
            const double front = booth::kBack - kEdge, back = -kHalf + kEdge;
            canvas_.polygon({at(front, from), at(front, to), at(back, to), at(back, from)},
                            fmt::format("fill=\"{}\"", shown(colours[i])));
        }
    }
    const Point middle = from_booth(booth, -booth::kSize / 2 - 0.008, 0.0);
    const Pixel p = canvas_.at(middle.x, middle.y);
    canvas_.text({p.x, p.y + 4}, booth.name,
                 fmt::format("text-anchor=\"middle\" font-size=\"11\" fill=\"#555\" {}", kHalo));
}

void Picture::booths() {
    double end = 0.0;
    for (const auto& [name, points] : robots_)
        if (!points.empty()) end = std::max(end, points.back().seconds);
    for (const BoothColours& one : booths_)
        if (!one.colours.empty()) end = std::max(end, one.colours.back().seconds);
    for (const Booth& one : world_.booths)
        booth(one, end);
}

}  // namespace puckloop::physics
