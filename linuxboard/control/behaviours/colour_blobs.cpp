#include "linuxboard/control/behaviours/colour_blobs.h"

#include <algorithm>
#include <cmath>
#include <numeric>

namespace puckloop::control {

namespace {

constexpr double kCalibratedHeight = 288;  // rows of MirrorCalibration
constexpr int kFull = 255;
constexpr double kSector = 60.0;  // degrees of hue from one colour to the next

struct Named {
    std::string_view name;
    double hue;
};
constexpr Named kColours[] = {{"red", 0},    {"yellow", 60}, {"green", 120},
                              {"cyan", 180}, {"blue", 240},  {"magenta", 300}};

/// Is the pixel of the colour? Full-range YCbCr.
bool belongs(int y, int u, int v, const ColourRange& colour) {
    const double r = std::clamp(y + 1.402 * (v - 128), 0.0, 255.0);
    const double g = std::clamp(y - 0.344136 * (u - 128) - 0.714136 * (v - 128), 0.0, 255.0);
    const double b = std::clamp(y + 1.772 * (u - 128), 0.0, 255.0);
    const double high = std::max({r, g, b}), low = std::min({r, g, b});
    if (high < colour.value || (high - low) * kFull < colour.saturation * high) return false;
    const double range = high - low;
    double hue = 0;
    if (high == r)
        hue = kSector * (g - b) / range;
    else if (high == g)
        hue = kSector * (2 + (b - r) / range);
    else
        hue = kSector * (4 + (r - g) / range);
    return std::abs(std::remainder(hue - colour.hue, 360.0)) <= colour.hue_tolerance;
}

/// A stretch of pixels of the colour in one row.
struct Run {
    std::size_t row = 0, first = 0, last = 0;
    std::size_t group = 0;
};

std::size_t root(std::vector<Run>& runs, std::size_t index) {
    while (runs[index].group != index)
        index = runs[index].group = runs[runs[index].group].group;
    return index;
}

/// Runs that touch those of the row above, corners included, join their groups.
void join(std::vector<Run>& runs, std::size_t above, std::size_t begin) {
    for (std::size_t i = begin; i < runs.size(); ++i)
        for (std::size_t k = above; k < begin; ++k) {
            if (runs[k].last + 1 < runs[i].first || runs[i].last + 1 < runs[k].first) continue;
            const std::size_t a = root(runs, i), b = root(runs, k);
            runs[std::max(a, b)].group = std::min(a, b);
        }
}

}  // namespace

std::optional<ColourRange> colour_named(std::string_view name) {
    for (const Named& known : kColours)
        if (known.name == name) return ColourRange{.hue = known.hue};
    return std::nullopt;
}

std::vector<ColourBlob> find_blobs(std::span<const std::uint8_t> yuyv, std::size_t width, std::size_t height,
                                   const ColourRange& colour, const MirrorCalibration& mirror, int least) {
    const double scale = static_cast<double>(height) / kCalibratedHeight;
    const double centre_u = static_cast<double>(width) / 2 + (mirror.centre_u - 176) * scale;
    const double centre_v = mirror.centre_v * scale;
    const double radius = mirror.radius * scale;
    std::vector<Run> runs;
    std::size_t above = 0;  // where the runs of the row before begin
    for (std::size_t row = 0; row < height && (row + 1) * width * 2 <= yuyv.size(); ++row) {
        const double dv = static_cast<double>(row) + 0.5 - centre_v;
        if (std::abs(dv) >= radius) continue;
        const double half = std::sqrt(radius * radius - dv * dv);
        const auto from = static_cast<std::size_t>(std::max(0.0, centre_u - half));
        const auto to =
            static_cast<std::size_t>(std::clamp(centre_u + half, 0.0, static_cast<double>(width)));
        const std::uint8_t* line = yuyv.data() + row * width * 2;
        const std::size_t begin = runs.size();
        bool open = false;
        for (std::size_t u = from; u < to; ++u) {
            const std::uint8_t* pair = line + u / 2 * 4;
            const bool inside = belongs(line[u * 2], pair[1], pair[3], colour);
            if (inside && open) runs.back().last = u;
            if (inside && !open) runs.push_back({row, u, u, runs.size()});
            open = inside;
        }
        if (above < begin && runs[begin - 1].row + 1 == row) join(runs, above, begin);
        above = begin;
    }

    struct Sum {
        double u = 0, v = 0, area = 0;
    };
    std::vector<Sum> sums(runs.size());
    for (std::size_t i = 0; i < runs.size(); ++i) {
        Sum& sum = sums[root(runs, i)];
        const auto length = static_cast<double>(runs[i].last - runs[i].first + 1);
        sum.u += length * (static_cast<double>(runs[i].first + runs[i].last) / 2 + 0.5);
        sum.v += length * (static_cast<double>(runs[i].row) + 0.5);
        sum.area += length;
    }
    std::vector<ColourBlob> blobs;
    for (const Sum& sum : sums) {
        if (sum.area < least) continue;
        const double ahead = centre_u - sum.u / sum.area;  // ahead is left in the picture, left is up
        const double leftward = centre_v - sum.v / sum.area;
        blobs.push_back({std::atan2(leftward, ahead),
                         mirror.curve_a * std::pow(mirror.curve_b, std::hypot(ahead, leftward) / scale),
                         static_cast<int>(sum.area)});
    }
    std::stable_sort(blobs.begin(), blobs.end(),
                     [](const ColourBlob& a, const ColourBlob& b) { return a.area > b.area; });
    return blobs;
}

}  // namespace puckloop::control
